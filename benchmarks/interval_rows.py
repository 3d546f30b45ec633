"""What a study of intervals keeps of a campaign, and shares of campaigns whose intervals hold."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from scipy.stats import binom

from sysid.jobs.rows import shortened
from sysid.trials.proportions import LEVEL, bootstrap

BAND: Final = 0.999
HOLDS, MISSES, OPEN = "+", "-", "."
"""Of a parameter's interval: it has the truth inside, has it not, or is called not identified."""
Interval = tuple[float, float, bool]


def told(found: dict[str, dict[str, Interval]], truth: dict[str, float]) -> dict[str, Any]:
    """What is kept of intervals: a sign for each parameter and kind, and how wide the kinds are.

    Args:
        found: Kind → symbol → low, high, and whether the parameter is called identified.
        truth: Symbol → value.

    Returns:
        ``symbols``; ``holds``, kind → a sign for each; ``half``, kind → median half width, parts of
        the true value, of parameters that all kinds call identified.
    """
    common = [s for s in truth if all(ends[s][2] for ends in found.values())]

    def sign(ends: Interval, value: float) -> str:
        return OPEN if not ends[2] else HOLDS if ends[0] <= value <= ends[1] else MISSES

    def half(ends: Interval, value: float) -> float:
        return 0.5 * (ends[1] - ends[0]) / abs(value)

    return {
        "symbols": list(truth),
        "holds": {
            kind: "".join(sign(here[s], truth[s]) for s in truth) for kind, here in found.items()
        },
        "half": shortened(
            {
                kind: float(np.median([half(here[s], truth[s]) for s in common]))
                if common else None for kind, here in found.items()
            }, 3,
        ),
    }  # fmt: skip


class Told:
    """Shares of the intervals of one kind that hold the truth.

    Args:
        rows: Campaigns.
        kind: Of interval.
    """

    def __init__(self, rows: Sequence[dict[str, Any]], kind: str) -> None:
        self.hits: dict[str, list[bool]] = {}
        self.campaigns: list[tuple[int, int]] = []
        for row in rows:
            signs = row["holds"][kind]
            for symbol, sign in zip(row["symbols"], signs, strict=True):
                if sign != OPEN:
                    self.hits.setdefault(symbol, []).append(sign == HOLDS)
            self.campaigns.append((signs.count(HOLDS), len(signs) - signs.count(OPEN)))
        halves = [row["half"][kind] for row in rows if row["half"][kind] is not None]
        self.half = float(np.median(halves)) if halves else float("nan")

    def pooled(self) -> tuple[float, float, float]:
        """Share with its interval, campaigns drawn anew as wholes."""
        both = np.array(self.campaigns)
        return bootstrap(lambda k: float(both[k, 0].sum() / both[k, 1].sum()), len(both))

    def outside(self) -> dict[str, tuple[int, int]]:
        """Parameters whose own share is outside its 99.9 % binomial band: hits, trials."""
        out = {}
        for symbol, inside in self.hits.items():
            low, high = binom.interval(BAND, len(inside), LEVEL)
            if not low <= sum(inside) <= high:
                out[symbol] = (sum(inside), len(inside))
        return out
