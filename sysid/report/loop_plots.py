"""Pictures of loops: all that were measured, and measured beside simulated."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_hex

from sysid.data.loops import Loops
from sysid.identification.straight_lines.levels import amperes, current_levels
from sysid.report.figure import closed, new_axes, new_figure, png

APART: Final = 5.0
"""K between the coldest test and the warmest of one current, from which colours show temperature:
tests that are meant at one temperature differ by less."""


def plot_force_velocity(loops: Loops, *, ax: Axes | None = None) -> Axes:
    """All loops, force over velocity, coloured by current, or by temperature at one current."""
    ax = _all(loops, loops.velocity, new_axes(ax))
    ax.set_xlabel("velocity / (m/s), compression positive")
    return ax


def plot_force_displacement(loops: Loops, *, ax: Axes | None = None) -> Axes:
    """All loops, force over displacement from the centre, coloured as over velocity."""
    ax = _all(loops, 1e3 * loops.displacement, new_axes(ax))
    ax.set_xlabel("displacement from the centre / mm, compression positive")
    return ax


def plot_fit_velocity(data: tuple[Loops, int, np.ndarray], *, ax: Axes | None = None) -> Axes:
    """One loop measured and simulated, force over velocity.

    Args:
        data: Loops, index of the loop, simulated force [J] N.
        ax: Where to draw.
    """
    loops, k, force = data
    ax = _compare(loops.velocity[k], loops.force[k], force, new_axes(ax))
    ax.set_xlabel("velocity / (m/s), compression positive")
    return ax


def plot_fit_displacement(data: tuple[Loops, int, np.ndarray], *, ax: Axes | None = None) -> Axes:
    """One loop over displacement, measured and simulated, [J] N; `data` as `plot_fit_velocity`."""
    loops, k, force = data
    ax = _compare(1e3 * loops.displacement[k], loops.force[k], force, new_axes(ax))
    ax.set_xlabel("displacement from the centre / mm, compression positive")
    return ax


def loops_png(loops: Loops, title: str) -> bytes:
    """All loops over velocity and over displacement, as PNG."""
    figure, (left, right) = new_figure(2)
    plot_force_velocity(loops, ax=left)
    plot_force_displacement(loops, ax=right)
    shade = _shade(loops)
    if shade.label:
        figure.colorbar(shade.colours, ax=right, label=shade.label)
    if (current := _only_current(loops)) is not None:
        title = f"{title}, {amperes(current)} A"
    figure.suptitle(title)
    return png(figure)


def worst_png(loops: Loops, index: int, force: np.ndarray, title: str) -> bytes:
    """One loop measured and simulated, over velocity and over displacement, as PNG.

    Args:
        loops: All tests.
        index: Of the test.
        force: [J] N, simulated.
        title: Above it.
    """
    figure, (left, right) = new_figure(2)
    plot_fit_velocity((loops, index, force), ax=left)
    plot_fit_displacement((loops, index, force), ax=right)
    figure.suptitle(title)
    return png(figure)


@dataclass(frozen=True)
class _Shade:
    """What the colours of loops tell.

    Attributes:
        values: [L] (NaN where unknown).
        colours: From the lowest of them to the highest.
        label: Of their scale; empty where all are the same.
    """

    values: Float[np.ndarray, " loop"]
    colours: ScalarMappable
    label: str


def _shade(loops: Loops) -> _Shade:
    """Currents; temperatures where one current is known; one colour where they are alike, too."""
    current, temperature = _known(loops.current), _known(loops.temperature)
    if current.size and len(current_levels(current)) > 1:
        return _Shade(loops.current, _over(current), "current / A")
    if temperature.size and np.ptp(temperature) >= APART:
        return _Shade(loops.temperature, _over(temperature), "temperature / °C")
    alike = np.where(np.isfinite(loops.current), 0.5, np.nan)
    return _Shade(alike, _over(np.array([0.0, 1.0])), "")


def _over(values: Float[np.ndarray, " known"]) -> ScalarMappable:
    return ScalarMappable(Normalize(values.min(), values.max()), colormaps["viridis"])


def _known(values: Float[np.ndarray, " loop"]) -> Float[np.ndarray, " known"]:
    return values[np.isfinite(values)]


def _only_current(loops: Loops) -> float | None:
    """A, that all loops were meant to have; None where they differ or one is unknown."""
    if not np.isfinite(loops.current).all():
        return None
    levels = current_levels(loops.current)
    return levels[0][0] if len(levels) == 1 else None


def _all(loops: Loops, x: np.ndarray, ax: Axes) -> Axes:
    shade = _shade(loops)
    for k in range(len(loops.ids)):
        value = shade.values[k : k + 1]
        colour = to_hex(shade.colours.to_rgba(value)[0]) if np.isfinite(value[0]) else "grey"
        ax.plot(closed(x[k]), closed(loops.force[k]), color=colour, linewidth=0.9)
    ax.set_ylabel("force / N")
    ax.grid(alpha=0.3)
    return ax


def _compare(x: np.ndarray, measured: np.ndarray, simulated: np.ndarray, ax: Axes) -> Axes:
    ax.plot(closed(x), closed(measured), color="black", linewidth=1.2, label="measured")
    ax.plot(closed(x), closed(simulated), color="tab:red", linewidth=1.2, label="simulated")
    ax.set_ylabel("force / N")
    ax.grid(alpha=0.3)
    ax.legend()
    return ax
