"""What each law of the damper does to its isolator as it warms."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sysid.isolator.card_study import CardStudy
from sysid.isolator.compare import Change
from sysid.report.conflict_plot import COLOURS
from sysid.report.figure import new_axes, png


def plot_warm_laws(
    data: tuple[dict[str, tuple[Change, ...]], str], *, ax: Axes | None = None
) -> Axes:
    """Changes of one performance by each law, with 95 % intervals of the mean over motions.

    Args:
        data: Law → change of each controller; "acceleration" or "working_space".
        ax: Where to draw.
    """
    laws, kind = data
    ax = new_axes(ax)
    names = [c.name for c in next(iter(laws.values()))]
    width = 0.8 / len(names)
    for k, name in enumerate(names):
        bands = [getattr(changes[k], kind) for changes in laws.values()]
        place = np.arange(len(laws)) + width * (k - 0.5 * (len(names) - 1))
        value = 100.0 * np.array([b.value for b in bands])
        ends = 100.0 * np.array([[b.low for b in bands], [b.high for b in bands]])
        error = np.abs(ends - value)
        ax.bar(
            place, value, width, color=COLOURS.get(name, "black"), alpha=0.7, label=name,
            yerr=error, error_kw={"linewidth": 0.8},
        )  # fmt: skip
    ax.set_xticks(np.arange(len(laws)), list(laws))
    ax.axhline(0.0, color="black", linewidth=0.6)
    ax.set_ylabel(f"change of RMS {kind.replace('_', ' ')} / %")
    ax.grid(alpha=0.3, axis="y")
    ax.legend(fontsize=8)
    return ax


def warm_laws_png(study: CardStudy) -> bytes:
    """Acceleration and working space side by side, as PNG."""
    figure = Figure(figsize=(13.0, 4.6), layout="constrained")
    for ax, kind in zip(figure.subplots(1, 2), ("acceleration", "working_space"), strict=True):
        plot_warm_laws((study.laws, kind), ax=ax)
    cold, warm = study.temperatures[0], study.temperatures[-1]
    figure.suptitle(
        f"One law at {warm:g} °C, the others at {cold:g} °C; whiskers: 95 % of the mean"
    )
    return png(figure)
