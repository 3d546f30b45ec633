"""Pictures of the straight-line recipes: points used on the loops, lines against temperature."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sysid.data.loops import Loops
from sysid.identification.straight_lines.choice import printed_level
from sysid.identification.straight_lines.levels import amperes, by_current
from sysid.identification.straight_lines.recipes import StraightLines, TemperatureLine
from sysid.identification.straight_lines.stage import Reading, Stage
from sysid.report.figure import new_axes, png

COLOURS = ("tab:blue", "tab:red")
"""Coldest test, warmest test."""


def plot_points_used(
    data: tuple[Loops, Stage], *, over: str = "velocity", ax: Axes | None = None
) -> Axes:
    """A cold and a warm loop, the points that a recipe used, and its line through them.

    Args:
        data: Loops, and a stage read off them.
        over: What force is drawn over, `velocity` or `displacement`.
        ax: Where to draw.
    """
    loops, stage = data
    ax = new_axes(ax)
    name = "velocity / (m/s)" if over == "velocity" else "displacement / mm"
    _draw_used(loops, stage, over, ax)
    ax.set_xlabel(f"{name}, compression positive")
    ax.set_ylabel("force / N")
    ax.set_title(f"{stage.symbol}: points used ({stage.window})", fontsize=10)
    ax.grid(alpha=0.3)
    if stage.readings:
        ax.legend(fontsize=8, loc="upper left" if over == "velocity" else "lower center")
    if stage.readings and over == "displacement":
        _magnify(loops, stage, ax)
    return ax


def _draw_used(loops: Loops, stage: Stage, over: str, ax: Axes) -> None:
    scale, x = (1.0 if over == "velocity" else 1e3), getattr(loops, over)
    for reading, colour in zip(_cold_and_warm(stage.readings), COLOURS, strict=False):
        n, used = reading.test, reading.used
        ax.plot(
            scale * np.append(x[n], x[n, :1]), np.append(loops.force[n], loops.force[n, :1]),
            color=colour, linewidth=0.8, label=_label(reading),
        )  # fmt: skip
        ax.plot(scale * x[n, used], loops.force[n, used], ".", color=colour, markersize=4)
        for side in (x[n] > 0.0, x[n] < 0.0):
            _line_through(scale * x[n, used & side], loops.force[n, used & side], ax)


def _magnify(loops: Loops, stage: Stage, ax: Axes) -> None:
    """The reversal from compression, larger."""
    inset = ax.inset_axes((0.3, 0.3, 0.4, 0.5))
    _draw_used(loops, stage, "displacement", inset)
    reach = [
        1e3 * loops.displacement[r.test, r.used & (loops.displacement[r.test] > 0.0)]
        for r in _cold_and_warm(stage.readings)
    ]
    low, high = min(z.min() for z in reach), max(z.max() for z in reach)
    inset.set_xlim(low - 0.5 * (high - low), high + 0.2 * (high - low))
    inset.tick_params(labelsize=7)
    inset.grid(alpha=0.3)


def plot_against_temperature(
    data: tuple[Stage, Sequence[TemperatureLine]], *, ax: Axes | None = None
) -> Axes:
    """Values with standard errors, and the line of each current with its 95 % band."""
    stage, lines = data
    ax = new_axes(ax)
    colours = colormaps["viridis"](np.linspace(0.0, 0.9, max(len(lines), 1)))
    for told, colour in zip(lines, colours, strict=False):
        line = told.line
        t = np.linspace(line.temperature.min(), line.temperature.max(), 60)
        y, sd = line.at(t)
        ax.plot(t, y, color=colour, linewidth=1.0, label=f"{amperes(told.current)} A")
        half = line.quantile * sd
        ax.fill_between(t, y - half, y + half, color=colour, alpha=0.2, linewidth=0.0)
        ax.errorbar(
            line.temperature, line.value, line.sd, fmt=".", color=colour, markersize=4,
            elinewidth=0.7,
        )  # fmt: skip
    ax.set_xlabel("temperature / °C")
    ax.set_ylabel(f"{stage.symbol} / {stage.unit if stage.unit == 'N' else f'({stage.unit})'}")
    if lines:
        ax.legend(fontsize=8)
    else:
        ax.text(0.5, 0.5, "not determined", ha="center", transform=ax.transAxes)
    ax.grid(alpha=0.3)
    return ax


def straight_lines_png(loops: Loops, found: StraightLines, title: str) -> bytes:
    """Points used above, lines against temperature below, one column a quantity."""
    figure = Figure(figsize=(16.0, 9.0), layout="constrained")
    axes = figure.subplots(2, 3)
    columns = (
        (found.viscosity, found.viscosity_lines, "velocity"),
        (found.yield_force, found.yield_lines, "velocity"),
        (found.stiffness, found.stiffness_lines, "displacement"),
    )
    for k, (stage, lines, over) in enumerate(columns):
        plot_points_used((loops, stage), over=over, ax=axes[0, k])
        plot_against_temperature((stage, lines), ax=axes[1, k])
    figure.suptitle(title)
    return png(figure)


def _cold_and_warm(readings: Sequence[Reading]) -> tuple[Reading, ...]:
    """Coldest and warmest test at the current that is printed; any one, where none is warm."""
    if not readings:
        return ()
    level = printed_level([r.current for r in readings])
    same = min(by_current(readings), key=lambda z: abs(z[0] - level))[1]
    warm = [r for r in same if np.isfinite(r.temperature)]
    if not warm:
        return (same[0],)
    ends = sorted(warm, key=lambda r: r.temperature)
    return (ends[0], ends[-1]) if len(ends) > 1 else (ends[0],)


def _label(reading: Reading) -> str:
    warm = f", {reading.temperature:.3g} °C" if np.isfinite(reading.temperature) else ""
    return f"{amperes(reading.current)} A{warm}"


def _line_through(x: np.ndarray, force: np.ndarray, ax: Axes) -> None:
    if x.size < 2:
        return
    slope, intercept = np.polyfit(x, force, 1)
    reach = np.array([x.min(), x.max()])
    reach += 0.15 * np.ptp(reach) * np.array([-1.0, 1.0])
    ax.plot(reach, slope * reach + intercept, color="black", linewidth=1.0)
