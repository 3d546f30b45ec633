"""How sure the best minimum of each damper is, from the ends of its starts.

The rule is that of single fits (`identification.multistart`), for all dampers at once.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from sysid.identification.multistart import FEW_HITS, NOTHING, SAME_BASIN
from sysid.identification.result import Basin


@dataclass(frozen=True)
class Evidence:
    """What the starts of D dampers found.

    Attributes:
        starts: [D] how many were made.
        basins: [D] minima seen.
        hits: [D] starts that ended in the best.
    """

    starts: Int[np.ndarray, " damper"]
    basins: Int[np.ndarray, " damper"]
    hits: Int[np.ndarray, " damper"]

    @property
    def enough(self) -> Bool[np.ndarray, " damper"]:
        """More starts would change nothing.

        Boender and Rinnooy Kan's estimate of the number of minima, w (S − 1)/(S − w − 2), does
        not exceed those seen by half a one, and the best was hit three times.  Fewer starts than
        the eight that the estimate asks for may do where all ended in one minimum.
        """
        w, starts = self.basins, self.starts
        room = starts - w - 2
        estimate = w * (starts - 1) / np.maximum(room, 1)
        counted = (room > 0) & (estimate < w + 0.5)
        return (self.hits >= FEW_HITS) & (counted | (self.hits == starts))


def evidence(
    cost: Float[np.ndarray, "damper start"], converged: Bool[np.ndarray, "damper start"]
) -> Evidence:
    """Group the ends of converged starts (of all, where none converged) by cost.

    Args:
        cost: [D, S]; NaN where a damper had no such start.
        converged: [D, S].
    """
    made = ~np.isnan(cost)
    kept = made & np.isfinite(cost)
    sound = kept & converged
    kept = np.where(sound.any(axis=1, keepdims=True), sound, kept)
    order = np.sort(np.where(kept, cost, np.inf), axis=1)
    first = order[:, 0].copy()
    basins, hits = np.ones(len(cost), dtype=int), np.isfinite(first).astype(int)
    for column in order.T[1:]:
        new = column > first * (1.0 + SAME_BASIN) + NOTHING
        there = np.isfinite(column)
        hits += there & ~new & (basins == 1)
        first = np.where(there & new, column, first)
        basins += there & new
    return Evidence(made.sum(axis=1), basins, hits)


def basins(
    cost: Float[np.ndarray, " start"], converged: Bool[np.ndarray, " start"]
) -> tuple[Basin, ...]:
    """The minima that the starts of one damper ended in, best first, as a single fit lists them.

    Args:
        cost: [S]; NaN where there was no such start.
        converged: [S].
    """
    kept = cost[np.isfinite(cost) & converged]
    if not kept.size:
        kept = cost[np.isfinite(cost)]
    first: list[float] = []
    hits: list[int] = []
    for one in np.sort(kept):
        if first and one <= first[-1] * (1.0 + SAME_BASIN) + NOTHING:
            hits[-1] += 1
        else:
            first.append(float(one))
            hits.append(1)
    best = max(first[0], NOTHING) if first else 1.0
    return tuple(Basin(max(c, NOTHING) / best, h) for c, h in zip(first, hits, strict=True))


def candidates(
    cost: Float[np.ndarray, " start"], count: int = 3, near: float = 1.05
) -> Int[np.ndarray, " chosen"]:
    """Starts whose ends may be the best on all data: the best, and others that come near it.

    Args:
        cost: [S] of one damper on a part of its data.
        count: At most.
        near: Cost over the best up to which the order may change.
    """
    order = np.argsort(np.where(np.isfinite(cost), cost, np.inf))
    chosen = [order[0]]
    for k in order[1:]:
        if len(chosen) == count or not cost[k] <= near * cost[order[0]]:
            break
        if cost[k] > cost[chosen[-1]] * (1.0 + SAME_BASIN):
            chosen.append(k)
    return np.array(chosen)
