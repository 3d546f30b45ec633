"""Intervals of parameters by several rules side by side."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from sysid.report.figure import new_axes
from sysid.uncertainty.estimate import Estimates

WIDEST = 0.5
"""Share of the value beyond which an interval is cut, with an arrow."""


def plot_intervals(
    data: tuple[Sequence[Estimates], Mapping[str, float] | None], *, ax: Axes | None = None
) -> Axes:
    """Interval of each free parameter by each rule, in per cent about the first rule's value.

    Args:
        data: Estimates by each rule, of the same model; symbol → true value, where it is known.
        ax: Where to draw.
    """
    rules, truth = data
    ax = new_axes(ax)
    symbols = [s for s in rules[0].symbols if _of(rules[0], s)[0] != 0.0]
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, max(len(rules), 2)))
    for k, (rule, colour) in enumerate(zip(rules, colours, strict=False)):
        lift = 0.7 * ((k + 0.5) / len(rules) - 0.5)
        for row, symbol in enumerate(symbols):
            middle = _of(rules[0], symbol)[0]
            value, *ends = (_relative(z, middle) for z in _of(rule, symbol))
            low, high = sorted(ends)
            y, reach = row + lift, 100.0 * WIDEST
            ax.plot(np.clip([low, high], -reach, reach), [y, y], color=colour, linewidth=2.0,
                    label=rule.interval if row == 0 else None)  # fmt: skip
            ax.plot(np.clip(value, -reach, reach), y, "o", color=colour, markersize=3.5)
            for end, mark in ((low, "<"), (high, ">")):
                if abs(end) > reach:
                    ax.plot(np.sign(end) * reach, y, mark, color=colour, markersize=6)
    if truth is not None:
        at = [_relative(truth[s], _of(rules[0], s)[0]) for s in symbols]
        shown = np.abs(at) <= 100.0 * WIDEST
        ax.plot(np.array(at)[shown], np.flatnonzero(shown), "|", color="tab:red", markersize=22,
                markeredgewidth=1.6, label="truth")  # fmt: skip
    ax.axvline(0.0, color="0.5", linewidth=0.8)
    ax.set_yticks(range(len(symbols)), symbols)
    ax.set_ylim(len(symbols) - 0.5, -0.5)
    ax.set_xlabel("deviation from the fitted value / %")
    ax.grid(axis="x", alpha=0.3)
    ax.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.12))
    return ax


def _of(rule: Estimates, symbol: str) -> tuple[float, float, float]:
    parameter = next(p for p in rule.parameters if p.symbol == symbol)
    return parameter.value, parameter.low, parameter.high


def _relative(z: float, middle: float) -> float:
    return 100.0 * (z / middle - 1.0)
