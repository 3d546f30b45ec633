"""Where the draws of a posterior lie: every parameter, and every pair of parameters."""

from collections.abc import Mapping, Sequence
from typing import Final

import corner
import numpy as np
from matplotlib.figure import Figure

from sysid.report.figure import png
from sysid.uncertainty.posterior import Posterior

MOST_DRAWS: Final = 20_000
"""Drawn points; more make the same picture."""
SHOWN: Final = 0.995
"""Share of the draws of each parameter that an axis shows."""


def corner_png(posterior: Posterior, marks: Mapping[str, float] | None = None) -> bytes:
    """All pairs of free parameters, 39 and 86 % of the draws inside the contours.

    Args:
        posterior: The draws.
        marks: Symbol → value to mark, e.g. those of the fit.
    """
    return png(corner_figure(posterior, marks), dpi=70)


def corner_figure(
    posterior: Posterior,
    marks: Mapping[str, float] | None = None,
    symbols: Sequence[str] | None = None,
) -> Figure:
    """The figure.

    Args:
        posterior: The draws.
        marks: Symbol → value to mark.
        symbols: Which parameters; all free ones if None.
    """
    names = [s for s in posterior.symbols if symbols is None or s in symbols]
    chosen = [posterior.symbols.index(s) for s in names]
    draws = posterior.flat[:: max(1, len(posterior.flat) // MOST_DRAWS)][:, chosen]
    units = [posterior.declared[k].unit for k in chosen]
    size = 1.5 * len(names) + 1.0
    return corner.corner(
        draws,
        fig=Figure(figsize=(size, size)),
        labels=[n if u == "-" else f"{n} / {u}" for n, u in zip(names, units, strict=True)],
        range=[SHOWN] * len(names),
        truths=None if marks is None else [marks.get(n) for n in names],
        truth_color="tab:orange",
        levels=(1.0 - np.exp(-0.5), 1.0 - np.exp(-2.0)),
        bins=30,
        smooth=0.8,
        plot_datapoints=False,
        max_n_ticks=3,
        label_kwargs={"fontsize": 11},
        labelpad=0.08,
    )
