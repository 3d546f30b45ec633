"""The score screen: how well each effect, alone, would explain what the base model leaves."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sysid.diagnosis.result import Diagnosis, ScreenRow
from sysid.diagnosis.scores import INVISIBLE
from sysid.report.before_after_plot import AFTER, BEFORE
from sysid.report.figure import new_axes, png

SMALLEST = 0.1
"""Scores below this are drawn here: a logarithmic axis has no zero, and they say nothing."""


def plot_screen(data: tuple[Sequence[ScreenRow], Sequence[str]], *, ax: Axes | None = None) -> Axes:
    """Score of each effect with the threshold that it must exceed, best on top.

    Args:
        data: Rows of the screen; ids of the effects that were asserted.
        ax: Where to draw.
    """
    rows, asserted = data
    ax = new_axes(ax)
    seen = sorted((r for r in rows if visible(r)), key=lambda r: -r.score)
    hidden = [r for r in rows if not visible(r)]
    for y, row in enumerate(seen):
        over = row.score > row.threshold
        score = max(row.score, SMALLEST)
        ax.plot([SMALLEST, score], [y, y], color=AFTER if over else "0.55", linewidth=2.0)
        ax.plot(score, y, "o", color=AFTER if over else "0.55", markersize=6)
        ax.plot(row.threshold, y, "|", color=BEFORE, markersize=11, markeredgewidth=2.0)
    for y, _ in enumerate(hidden, start=len(seen)):
        ax.text(1.3 * SMALLEST, y, "these tests cannot show it", color="0.6", va="center", size=8)
    labels = [f"{r.id}  ◀ found" if r.id in asserted else r.id for r in (*seen, *hidden)]
    ax.set_yticks(range(len(labels)), labels, fontsize=8)
    for label, row in zip(ax.get_yticklabels(), (*seen, *hidden), strict=True):
        label.set_color("black" if visible(row) else "0.6")
        label.set_fontweight("bold" if row.id in asserted else "normal")
    ax.set_ylim(len(labels) - 0.4, -0.6)
    ax.set_xscale("log")
    ax.set_xlim(SMALLEST, 3.0 * max([r.score for r in seen] + [100.0]))
    if any(np.isfinite(row.threshold) for row in seen):
        ax.set_xlabel("score (χ² by which the effect alone would lower the misfit)")
        ax.plot([], [], "o-", color=AFTER, label="above its threshold")
        ax.plot([], [], "o-", color="0.55", label="below its threshold")
        ax.plot([], [], "|", color=BEFORE, markersize=11, markeredgewidth=2.0, label="threshold")
    else:
        ax.set_xlabel("score (by how much the effect alone would lower the misfit)")
        ax.plot([], [], "o-", color="0.55", label="no model is near: not held against chance")
    ax.legend(fontsize=8, loc="lower right")
    ax.grid(axis="x", alpha=0.3)
    return ax


def visible(row: ScreenRow) -> bool:
    """The tests could show this effect."""
    return bool(np.isfinite(row.score) and row.survival >= INVISIBLE)


def screen_png(diagnosis: Diagnosis) -> bytes:
    """The screen of the base model as PNG."""
    rows = diagnosis.screen
    figure = Figure(figsize=(8.5, 1.6 + 0.23 * len(rows)), layout="constrained")
    asserted = [c.id for c in diagnosis.causes if c.id is not None]
    plot_screen((rows, asserted), ax=figure.subplots())
    figure.suptitle("Each effect alone against what the base model leaves", fontsize=11)
    return png(figure)
