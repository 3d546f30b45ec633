"""Bands on loops: what is known of the force, beside what was measured."""

from itertools import chain
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sysid.report.figure import closed, new_axes, png
from sysid.uncertainty.bands import Error
from sysid.uncertainty.loop_bands import LoopBands

PANELS: Final = 6
COLUMNS: Final = 3
_MIDDLE: Final = "tab:red"
_MEDIAN: Final = "navy"
_FILLED: Final[tuple[tuple[Error, float], ...]] = (("recorded", 0.15), ("laws", 0.45))


def plot_band(data: tuple[LoopBands, int], *, ax: Axes | None = None) -> Axes:
    """Departure from the predicted force over the phase, with all bands.

    On a whole loop bands of one per cent are no wider than a line, so what is drawn is the
    measured force less the median of the prediction.

    Args:
        data: Bands, index of the test.
        ax: Where to draw.
    """
    bands, k = data
    ax = new_axes(ax)
    middle = bands.forces["parameters"].middle[k]
    phase = np.linspace(0.0, 360.0, middle.size + 1)
    if bands.conformal_band is not None:
        for end in (bands.conformal_band.low[k], bands.conformal_band.high[k]):
            ax.plot(phase, closed(end - middle), color="grey", linewidth=0.8, linestyle="--")
        ax.plot([], [], color="grey", linewidth=0.8, linestyle="--", label="conformal, whole loop")
    for kind, alpha in _FILLED:
        if kind in bands.forces:
            low, high = _ends(bands, kind, k)
            ax.fill_between(
                phase, low, high, color="tab:blue", alpha=alpha, linewidth=0, label=kind
            )
    for end in _ends(bands, "parameters", k):
        ax.plot(phase, end, color=_MIDDLE, linewidth=0.9)
    ax.plot([], [], color=_MIDDLE, linewidth=0.9, label="parameters")
    measured = closed(bands.measured[k] - middle)
    ax.plot(phase, measured, color="black", linewidth=0.8, label="measured")
    ax.set_xlim(0.0, 360.0)
    ax.set_xticks(np.arange(0.0, 361.0, 90.0))
    ax.grid(alpha=0.3)
    return ax


def plot_band_loop(data: tuple[LoopBands, int], *, ax: Axes | None = None) -> Axes:
    """The loop, force over velocity, with the band of what would be recorded; `data` as above."""
    bands, k = data
    ax, v = new_axes(ax), closed(bands.velocity[k])
    band = bands.forces["recorded"]
    turn = int(np.argmax(v)), int(np.argmin(v))
    for half in (slice(turn[0], turn[1] + 1), np.r_[turn[1] : v.size, 0 : turn[0] + 1]):
        low, high = (closed(end[k])[half] for end in (band.low, band.high))
        ax.fill_between(v[half], low, high, color="tab:blue", alpha=0.25, linewidth=0)
    ax.plot(v, closed(band.middle[k]), color=_MEDIAN, linewidth=0.9, label="median (loops)")
    ax.plot(v, closed(bands.measured[k]), color="black", linewidth=0.9)
    ax.grid(alpha=0.3)
    return ax


def bands_png(bands: LoopBands, title: str) -> bytes:
    """Some loops, and below each its departures with all bands, as PNG."""
    chosen = shown(bands)
    columns = min(COLUMNS, len(chosen))
    rows = -(-len(chosen) // columns)
    figure = Figure(figsize=(5.0 * columns, 5.6 * rows), layout="constrained")
    grid = figure.subplots(2 * rows, columns, squeeze=False)
    for place, k in enumerate(chosen):
        row, column = 2 * (place // columns), place % columns
        above, below = grid[row][column], grid[row + 1][column]
        plot_band_loop((bands, k), ax=above)
        plot_band((bands, k), ax=below)
        kind = "held out" if bands.held_out[k] else "fitted"
        above.set_title(f"{bands.ids[k]} ({kind}): {bands.inside[k]:.0%} inside", fontsize=10)
        above.set_xlabel("velocity / (m/s)")
        below.set_xlabel("phase / °")
        if column == 0:
            above.set_ylabel("force / N")
            below.set_ylabel("measured − median / N")
    for place in range(len(chosen), rows * columns):
        for row in (0, 1):
            grid[2 * (place // columns) + row][place % columns].set_axis_off()
    figure.suptitle(title)
    told = [grid[row][0].get_legend_handles_labels() for row in (1, 0)]
    marks, labels = (list(chain.from_iterable(z)) for z in zip(*told, strict=True))
    figure.legend(marks, labels, loc="outside lower center", ncols=len(labels), fontsize=9)
    return png(figure)


def shown(bands: LoopBands) -> list[int]:
    """Up to half of the panels for tests held out, the others fitted: from weak to strong."""
    peak = np.abs(bands.measured).max(axis=1)
    held = _spread(np.flatnonzero(bands.held_out), peak, PANELS // 2)
    return [*held, *_spread(np.flatnonzero(~bands.held_out), peak, PANELS - len(held))]


def _ends(bands: LoopBands, kind: Error, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Of a band less the median of the prediction, N, closed."""
    band, middle = bands.forces[kind], bands.forces["parameters"].middle[k]
    return closed(band.low[k] - middle), closed(band.high[k] - middle)


def _spread(which: np.ndarray, by: np.ndarray, count: int) -> list[int]:
    ordered = which[np.argsort(by[which])]
    some = np.linspace(0, len(ordered) - 1, min(count, len(ordered))).astype(int)
    return [int(k) for k in ordered[some]]
