"""Conflict diagrams: RMS acceleration over RMS working space."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sysid.isolator.card_study import SHOWN, CardStudy, Drawn
from sysid.isolator.compare import band, nearest
from sysid.isolator.study import Curve
from sysid.report.figure import new_axes, png

COLOURS: Final = {
    "P": "tab:blue", "PID": "tab:cyan", "GS": "tab:green", "OO": "tab:red",
    "passive": "grey",
}  # fmt: skip
STYLES: Final = ("-", "--")
FILLS: Final = {"-": "full", "--": "none"}
"""Style of a line → how its marks are filled: what is hollow is told apart on grey paper, too."""
Points = Sequence[tuple[int, int]]
"""Set point and variant of each point of a line."""


def plot_conflict(
    data: tuple[Curve, Points],
    *,
    ax: Axes | None = None,
    style: str = "-",
    label: str | None = None,
) -> Axes:
    """A line through some runs of one controller, means over motions, with a 95 % band.

    The band is that of the mean acceleration; motions differ by more, alike for all controllers.

    Args:
        data: Curve; which of its set points and variants.
        ax: Where to draw.
        style: Of the line.
        label: In the legend.
    """
    curve, points = data
    ax = new_axes(ax)
    space = np.array([1e3 * curve.working_space[k, v].mean() for k, v in points])
    bands = [band(curve.acceleration[k, v]) for k, v in points]
    colour = COLOURS.get(curve.name, "black")
    order = np.argsort(space)
    low, high = (np.array([getattr(b, end) for b in bands])[order] for end in ("low", "high"))
    if np.all(np.isfinite(low)):
        ax.fill_between(space[order], low, high, color=colour, alpha=0.12, linewidth=0)
    ax.plot(
        space, [b.value for b in bands], style, color=colour, marker="o", markersize=4,
        fillstyle=FILLS[style], linewidth=1.1, label=label, zorder=3,
    )  # fmt: skip
    return ax


def plot_drawn(data: tuple[Curve, Drawn, int], *, ax: Axes | None = None) -> Axes:
    """A controller's set points for every drawn damper, as dots: lines would cover the curves.

    Args:
        data: The card's own curve; what drawn dampers make of it; 0 for cold, 1 for warm.
        ax: Where to draw.
    """
    curve, drawn, end = data
    ax = new_axes(ax)
    variant = 0 if end == 0 else curve.working_space.shape[1] - 1
    space, height = (
        z[:, variant].mean(axis=1)[:, None] * over[:, end]
        for z, over in (
            (1e3 * curve.working_space, drawn.working_space),
            (curve.acceleration, drawn.acceleration),
        )
    )
    ax.plot(
        space, height, ".", color=COLOURS.get(curve.name, "black"), markersize=2, alpha=0.35,
        markeredgewidth=0, zorder=2,
    )  # fmt: skip
    return ax


def conflict_png(study: CardStudy) -> bytes:
    """Over temperature, and over set points at both ends of temperature, as PNG."""
    figure = Figure(figsize=(13.0, 5.2), layout="constrained")
    over_warmth, over_points = figure.subplots(1, 2)
    last = len(study.temperatures) - 1
    for curve in study.diagram.curves:
        at = nearest(curve.set_points, SHOWN[curve.name])
        told = f"{curve.name}, {_setting(curve, at)}"
        plot_conflict((curve, [(at, v) for v in range(last + 1)]), ax=over_warmth, label=told)
        if last:
            _ring(curve, at, last, over_warmth)
        for end, style in _ends(last):
            plot_conflict(
                (curve, [(k, end) for k in range(len(curve.set_points))]), ax=over_points,
                style=style, label=f"{curve.name}, {study.temperatures[end]:g} °C",
            )  # fmt: skip
    for drawn in study.drawn:
        for end in range(drawn.acceleration.shape[1]):
            plot_drawn((study.diagram.curve(drawn.name), drawn, end), ax=over_points)
    plot_conflict((study.passive, [(0, v) for v in range(last + 1)]), ax=over_warmth, label="0 A")
    if last:
        _ring(study.passive, 0, last, over_warmth)
    over_warmth.set_title(_temperatures(study), fontsize=10)
    over_points.set_title("over the set point", fontsize=10)
    for ax in (over_warmth, over_points):
        _finish(ax)
    motions = f"{study.order.motions} motions"
    told = f"{study.diagram.motion}; bands: 95 % of the mean over {motions}"
    if study.drawn:
        count = study.drawn[0].acceleration.shape[2]
        told += f"\ndots: {count} dampers drawn from {study.drawn_from}"
    figure.suptitle(told, fontsize=11)
    return png(figure)


def rig_png(study: CardStudy) -> bytes:
    """Simulation and simulated rig side by side in one diagram, as PNG."""
    assert study.rig is not None
    last, figure = len(study.temperatures) - 1, Figure(figsize=(13.0, 5.2), layout="constrained")
    panels = figure.subplots(1, len(study.rig.variants), squeeze=False)[0]
    for panel, ax in enumerate(panels):
        for one, other in zip(study.diagram.curves, study.rig.curves, strict=True):
            for curve, variant, style, said in (
                (one, last if panel else 0, "-", "isolator"),
                (other, panel, "--", "in a simulated rig"),
            ):
                points = [(k, variant) for k in range(len(curve.set_points))]
                plot_conflict((curve, points), ax=ax, style=style, label=f"{curve.name}, {said}")
        ax.set_title(study.rig.variants[panel], fontsize=10)
        _finish(ax)
    return png(figure)


def _ends(last: int) -> list[tuple[int, str]]:
    return list(zip(sorted({0, last}), STYLES, strict=False))


def _setting(curve: Curve, at: int) -> str:
    return f"{curve.set_points[at]:g} {curve.unit}"


def _temperatures(study: CardStudy) -> str:
    t = study.temperatures
    if not t[1:]:
        return f"at {t[0]:g} °C"
    return f"over temperature, {t[0]:g} to {t[-1]:g} °C (ring: {t[-1]:g} °C)"


def _ring(curve: Curve, at: int, variant: int, ax: Axes) -> None:
    """Around one point of a curve."""
    ax.plot(
        1e3 * curve.working_space[at, variant].mean(), curve.acceleration[at, variant].mean(), "o",
        color=COLOURS.get(curve.name, "black"), fillstyle="none", markersize=10,
    )  # fmt: skip


def _finish(ax: Axes) -> None:
    ax.set_xlabel("RMS working space / mm")
    ax.set_ylabel("RMS acceleration / (m/s²)")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=7)
