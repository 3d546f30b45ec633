"""What the extension is worth: held-out error of every test before and after, over conditions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sysid.data.loops import Loops
from sysid.diagnosis.result import Diagnosis, Gain
from sysid.identification.conditions import conditions
from sysid.identification.straight_lines.levels import amperes, current_levels
from sysid.report.before_after_plot import AFTER, BEFORE
from sysid.report.figure import new_axes, png

MOST_CURRENTS = 8
"""Panels side by side; where there are more currents, neighbours share one."""


@dataclass(frozen=True)
class TestErrors:
    """Errors of tests at one current (or a few neighbouring ones), % of max|F|.

    Attributes:
        rows: [n] row of each test in the list of conditions.
        before: [n].
        after: [n].
        floor: [n] noise of the cycle mean; NaN with single cycles.
    """

    __test__ = False  # not a pytest class

    rows: np.ndarray
    before: Float[np.ndarray, " test"]
    after: Float[np.ndarray, " test"]
    floor: Float[np.ndarray, " test"]


def plot_gain(data: tuple[Sequence[str], TestErrors], *, ax: Axes | None = None) -> Axes:
    """Error of each test before and after, joined by a line, the noise of the mean cycle as a tick.

    Args:
        data: Names of the rows, worst first; errors.
        ax: Where to draw.
    """
    names, errors = data
    ax = new_axes(ax)
    y = errors.rows
    ax.hlines(y, errors.before, errors.after, color="0.7", linewidth=1.2, zorder=1)
    ax.plot(errors.before, y, "o", color=BEFORE, markersize=5, label="before")
    ax.plot(errors.after, y, "D", color=AFTER, markersize=4.5, label="after")
    ax.plot(errors.floor, y, "|", color="black", markersize=9, label="noise of the mean cycle")
    ax.set_yticks(range(len(names)), names, fontsize=8)
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.set_xlim(0.0, reach(errors))
    ax.grid(alpha=0.3)
    ax.set_xlabel("% of max|F|")
    return ax


def gain_png(diagnosis: Diagnosis) -> bytes | None:
    """All tests, one row a condition (amplitude, frequency), one panel a current; None if no gain.

    Rows are ordered by the base model's mean error, the worst on top.
    """
    gain = diagnosis.gain
    if gain is None:
        return None
    names, panels = arrange(diagnosis.loops, gain)
    figure = Figure(
        figsize=(2.0 + 2.3 * max(len(panels), 3), 1.8 + 0.24 * len(names)), layout="constrained"
    )
    axes = figure.subplots(1, len(panels), squeeze=False, sharex=True, sharey=True)[0]
    for ax, (title, errors) in zip(axes, panels.items(), strict=True):
        plot_gain((names, errors), ax=ax)
        ax.set_title(title, fontsize=10)
    axes[0].set_xlim(0.0, max(reach(errors) for errors in panels.values()))
    figure.suptitle(
        f"Held-out error: {gain.before:.1%} before, {gain.after:.1%} after "
        f"(mean over tests; noise of the mean cycle {gain.floor:.1%})",
        fontsize=11,
    )
    marks, labels = axes[0].get_legend_handles_labels()
    figure.legend(marks, labels, loc="outside lower center", ncols=len(labels), fontsize=9)
    return png(figure)


def reach(errors: TestErrors) -> float:
    """Right end of an axis that shows all of them, %."""
    every = np.concatenate([errors.before, errors.after, errors.floor])
    return 1.06 * float(every[np.isfinite(every)].max(initial=0.0)) or 1.0


def arrange(loops: Loops, gain: Gain) -> tuple[list[str], dict[str, TestErrors]]:
    """Rows and panels: conditions worst first, errors by current.

    Measured amplitudes and frequencies that are one condition of the fit share a row, named by
    their medians.

    Args:
        loops: L tests.
        gain: Their errors, in any order.
    """
    place = {name: k for k, name in enumerate(loops.ids)}
    at = np.array([place[name] for name in gain.held_out])
    group = conditions(loops)[at]
    groups = np.unique(group)
    order = np.argsort([-np.nanmean(gain.per_test_before[group == g]) for g in groups])
    names = [_condition(loops.select(at[group == g])) for g in groups[order]]
    rows = np.argsort(order)[np.searchsorted(groups, group)]
    floor = loops.mean_cycle_noise / np.abs(loops.force).max(axis=1)
    panels = {}
    for title, inside in _by_current(loops.current[at]).items():
        panels[title] = TestErrors(
            rows=rows[inside],
            before=100.0 * gain.per_test_before[inside],
            after=100.0 * gain.per_test_after[inside],
            floor=100.0 * floor[at][inside],
        )
    return names, panels


def _condition(loops: Loops) -> str:
    """Name of the condition that some loops share."""
    a, f = float(np.median(loops.amplitude)), float(np.median(loops.frequency))
    return f"{1e3 * a:.3g} mm, {f:.3g} Hz"


def _by_current(current: Float[np.ndarray, " test"]) -> dict[str, np.ndarray]:
    """Title → places of tests; neighbouring levels share a panel where there are many."""
    known = np.flatnonzero(np.isfinite(current))
    levels = [(amperes(z), known[places]) for z, places in current_levels(current[known])]
    panels = {}
    for group in np.array_split(np.arange(len(levels)), min(len(levels), MOST_CURRENTS) or 1):
        if group.size:
            low, high = levels[group[0]][0], levels[group[-1]][0]
            title = f"{low} A" if group.size == 1 else f"{low} … {high} A"
            panels[title] = np.concatenate([levels[k][1] for k in group])
    silent = np.flatnonzero(~np.isfinite(current))
    return panels | ({"current unknown": silent} if silent.size else {})
