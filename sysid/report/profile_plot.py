"""How the likelihood falls along each parameter, all others giving way."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from scipy.interpolate import PchipInterpolator
from scipy.special import chdtri

from sysid.report.figure import new_axes, png
from sysid.uncertainty.profiles import Profile

COLUMNS: Final = 4
TOP: Final = 2.0
"""Height of a panel, in rises of the interval's ends."""
WIDE: Final = 100.0
"""A path to so many times the parameter's size is drawn over the logarithm."""


def plot_profile(profile: Profile, *, ax: Axes | None = None) -> Axes:
    """Fall of the log-likelihood against the parameter, and its interval.

    Where Σ is estimated, over the square of how much wider that makes the parameter's interval
    (`uncertainty.profiles`): the dashed line is the same for all parameters.

    Args:
        profile: Of one parameter.
        ax: Where to draw.
    """
    ax = new_axes(ax)
    end = 0.5 * float(chdtri(1, 1.0 - profile.level))
    at = profile.values
    size = max(profile.best, profile.declared.typical)
    wide = bool(at[0] > 0.0 and at[-1] > WIDE * size)
    to_axis, from_axis = (np.log, np.exp) if wide else (np.asarray, np.asarray)
    if at.size > 1:
        fine = np.linspace(to_axis(at[0]), to_axis(at[-1]), 200)
        smooth = PchipInterpolator(to_axis(at), profile.root)(fine)
        ax.plot(from_axis(fine), 0.5 * smooth**2, color="tab:blue", linewidth=1.5)
    ax.plot(at, 0.5 * profile.rise, "o", color="tab:blue", markersize=3)
    ax.axhline(end, color="0.4", linestyle="--", linewidth=0.8)
    below, above = profile.closed
    low, high = profile.low if below else at[0], profile.high if above else at[-1]
    ax.axvspan(float(low), float(high), color="tab:blue", alpha=0.12, linewidth=0)
    spec = profile.declared
    ends = ((below, at[0], "left", spec.low), (above, at[-1], "right", spec.high))
    for closed, x, side, bound in ends:
        if not closed:
            words = "bound" if np.isfinite(bound) else "open"
            ax.annotate(words, (float(x), end), ha=side, va="bottom", fontsize=8, color="tab:red")
    ax.axvline(profile.best, color="tab:orange", linewidth=0.8)
    ax.set_ylim(-0.05 * end, TOP * end)
    unit = "" if profile.declared.unit == "-" else f" / {profile.declared.unit}"
    ax.set_xlabel(f"{profile.symbol}{unit}")
    if wide:
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(LogLocator(numticks=5))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        ax.xaxis.set_minor_locator(NullLocator())
    else:
        ax.locator_params(axis="x", nbins=4)
    ax.tick_params(labelsize=8)
    ax.grid(alpha=0.3)
    return ax


def profile_figure(profiles: Sequence[Profile]) -> Figure:
    """A panel for each parameter.

    Args:
        profiles: At least one.
    """
    rows = -(-len(profiles) // COLUMNS)
    figure = Figure(figsize=(3.0 * COLUMNS, 2.4 * rows + 0.6), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False)
    for ax, profile in zip(panels.ravel(), profiles, strict=False):
        plot_profile(profile, ax=ax)
    for ax in panels.ravel()[len(profiles) :]:
        ax.set_axis_off()
    for ax in panels[:, 0]:
        ax.set_ylabel("fall of the log-likelihood,\nscaled to one line", fontsize=9)
    percent = f"{100 * profiles[0].level:g} %"
    figure.suptitle(
        f"Profiles: all other parameters give way. Shaded: {percent} interval, below the dashed "
        "line; orange: most probable",
        fontsize=10,
    )
    return figure


def profile_png(profiles: Sequence[Profile]) -> bytes:
    """The figure as PNG."""
    return png(profile_figure(profiles))
