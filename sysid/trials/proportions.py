"""Shares and ratios with their uncertainty."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import stats

LEVEL = 0.95


@dataclass(frozen=True)
class Share:
    """A share of successes with its 95 % interval (Wilson).

    Source:
        E. B. Wilson, Probable inference, J. Am. Stat. Assoc. 22 (1927).
    """

    hits: int
    trials: int

    @property
    def value(self) -> float:
        """Hits / trials."""
        return self.hits / self.trials if self.trials else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's interval."""
        if not self.trials:
            return float("nan"), float("nan")
        found = stats.binomtest(self.hits, self.trials).proportion_ci(LEVEL, method="wilson")
        return float(found.low), float(found.high)

    def __str__(self) -> str:
        low, high = self.interval
        share = f"{100 * self.value:.1f} % ({100 * low:.1f} to {100 * high:.1f})"
        return f"{self.hits}/{self.trials} = {share}"

    def as_dict(self) -> dict[str, float]:
        """For JSON."""
        low, high = self.interval
        return {
            "hits": self.hits, "trials": self.trials, "share": self.value, "low": low, "high": high,
        }  # fmt: skip


def bootstrap(
    statistic: Callable[[np.ndarray], float], campaigns: int, *, draws: int = 2000, seed: int = 0
) -> tuple[float, float, float]:
    """A statistic of whole campaigns with its 95 % percentile interval.

    Args:
        statistic: Function of the indices of the campaigns to use, repeats included.
        campaigns: How many there are.
        draws: Resamples.
        seed: Of the resampling.

    Returns:
        Value, lower end, upper end; an end is infinite where too many resamples have no success.
    """
    rng = np.random.default_rng(seed)
    drawn = np.array([statistic(rng.integers(campaigns, size=campaigns)) for _ in range(draws)])
    low, high = np.quantile(drawn, [0.5 - LEVEL / 2, 0.5 + LEVEL / 2], method="nearest")
    return statistic(np.arange(campaigns)), float(low), float(high)
