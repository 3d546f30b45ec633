"""Does a quantity depend on current beside temperature?"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import f as fisher

from sysid.identification.straight_lines.lines import Line, fit_line, weighted_residuals
from sysid.identification.straight_lines.scatter import ScatterSplit
from sysid.identification.straight_lines.stage import Reading


@dataclass(frozen=True)
class Independence:
    """One line for all currents against a line for each.

    Attributes:
        line: The one line.
        currents: A, those that have a line of their own.
        p: Chance that one line for all leaves as much as was found (F test).
        difference: Largest difference between a current's line and the one line at the mean
            temperature, in parts of it.
    """

    line: Line
    currents: tuple[float, ...]
    p: float
    difference: float

    @property
    def shown(self) -> bool:
        """Whether the currents differ."""
        return self.p < 0.05


def independence_of(
    levels: Sequence[tuple[float, Sequence[Reading]]], scatter: ScatterSplit | None = None
) -> Independence | None:
    """Pool the tests of all currents and test whether that may be done.

    Args:
        levels: Current in A → its readings; those that cannot carry a line are left out.
        scatter: What is known of it, for the weights.

    Returns:
        None with fewer than two currents.
    """
    kept = [(z, _arrays(r)) for z, r in levels if len(r) >= 3]
    kept = [(z, a) for z, a in kept if np.ptp(a[0]) > 0.0]
    if len(kept) < 2:
        return None
    t, y, se, repeats = (
        np.concatenate(column) for column in zip(*(a for _, a in kept), strict=True)
    )
    pooled = fit_line(t, y, se, repeats)
    if scatter is not None:
        pooled = fit_line(t, y, se, repeats, beyond=scatter.beyond(pooled))
    of = np.repeat(np.arange(len(kept)), [a[0].size for _, a in kept])
    one = np.stack([np.ones_like(t), t - t.mean()], axis=1)
    each = np.concatenate([one * (of == k)[:, None] for k in range(len(kept))], axis=1)
    # weights that do not know whether the currents differ
    sd = pooled.sd
    freedom, terms = y.size - 2 * len(kept), 2 * (len(kept) - 1)
    cost, less = (float((weighted_residuals(rows, y, sd) ** 2).sum()) for rows in (one, each))
    p = float("nan")
    if freedom > 0:
        ratio = ((cost - less) / terms) / (less / freedom) if less > 0.0 else np.inf
        p = float(fisher.sf(ratio, terms, freedom))
    own = np.linalg.lstsq(each / sd[:, None], y / sd, rcond=None)[0][::2]
    middle = pooled.at(np.array([t.mean()]))[0][0]
    difference = float(np.abs(own / middle - 1.0).max())
    return Independence(pooled, tuple(z for z, _ in kept), p, difference)


def _arrays(readings: Sequence[Reading]) -> tuple[np.ndarray, ...]:
    table = [(r.temperature, r.value, r.se, float(r.replicates)) for r in readings]
    return tuple(np.array(table).T)
