"""Pictures of loops: all that were measured, and measured beside simulated."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_hex

from sysid.data.loops import Loops
from sysid.identification.straight_lines.levels import amperes, current_levels
from sysid.report.figure import new_axes, new_figure, png


def plot_force_velocity(loops: Loops, *, ax: Axes | None = None) -> Axes:
    """All loops, force over velocity, coloured by current."""
    ax = _all(loops, loops.velocity, new_axes(ax))
    ax.set_xlabel("velocity / (m/s), compression positive")
    return ax


def plot_force_displacement(loops: Loops, *, ax: Axes | None = None) -> Axes:
    """All loops, force over displacement from the centre, coloured by current."""
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
    known = loops.current[np.isfinite(loops.current)]
    levels = current_levels(known) if known.size else []
    if len(levels) > 1:
        figure.colorbar(_colours(loops), ax=right, label="current / A")
    elif known.size == loops.current.size:
        title = f"{title}, {amperes(levels[0][0])} A"
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


def _colours(loops: Loops) -> ScalarMappable:
    """From the lowest current to the highest; one colour where there is no other."""
    known = loops.current[np.isfinite(loops.current)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    if known.size and len(current_levels(known)) == 1:
        low, high = low - 1.0, low + 1.0
    return ScalarMappable(Normalize(low, high), colormaps["viridis"])


def _all(loops: Loops, x: np.ndarray, ax: Axes) -> Axes:
    colours = _colours(loops)
    for k in range(len(loops.ids)):
        i = loops.current[k : k + 1]
        colour = to_hex(colours.to_rgba(i)[0]) if np.isfinite(i[0]) else "grey"
        ax.plot(_closed(x[k]), _closed(loops.force[k]), color=colour, linewidth=0.9)
    ax.set_ylabel("force / N")
    ax.grid(alpha=0.3)
    return ax


def _compare(x: np.ndarray, measured: np.ndarray, simulated: np.ndarray, ax: Axes) -> Axes:
    ax.plot(_closed(x), _closed(measured), color="black", linewidth=1.2, label="measured")
    ax.plot(_closed(x), _closed(simulated), color="tab:red", linewidth=1.2, label="simulated")
    ax.set_ylabel("force / N")
    ax.grid(alpha=0.3)
    ax.legend()
    return ax


def _closed(values: np.ndarray) -> np.ndarray:
    return np.append(values, values[:1])
