"""Are two samples draws from one density: marginals compared within their Monte Carlo error."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from arviz_stats.base.array import array_stats
from jaxtyping import Float
from scipy.special import ndtri

ENDS: Final = (0.025, 0.975)
STATISTICS: Final = ("mean", "sd", "2.5 %", "97.5 %")
TAILS: Final = (0.05, 0.95)
CHANCE: Final = 1e-3
"""Probability that samples of one density are called different."""


@dataclass(frozen=True)
class Agreement:
    """How far two samples of n quantities are apart.

    Attributes:
        z: [4, n] difference of each of `STATISTICS` over its standard error.
        apart: [4, n] the same in standard deviations of the quantity.
    """

    z: Float[np.ndarray, "4 n"]
    apart: Float[np.ndarray, "4 n"]

    @property
    def bound(self) -> float:
        """Largest |z| that chance explains in so many (Bonferroni)."""
        return float(-ndtri(0.5 * CHANCE / self.z.size))

    @property
    def agrees(self) -> bool:
        """No statistic differs by more than chance explains."""
        return bool(np.abs(self.z).max() < self.bound)

    def words(self) -> str:
        """The test in a sentence."""
        rms = float(np.sqrt(np.mean(self.z**2)))
        return (
            f"largest |z| {np.abs(self.z).max():.2f} of {self.z.size} (chance: below "
            f"{self.bound:.2f} in {1.0 - CHANCE:.1%} of cases), RMS z {rms:.2f} (1 on average); "
            f"largest difference {np.abs(self.apart).max():.3f} sd"
        )


def agreement(
    one: Float[np.ndarray, "chain draw n"], other: Float[np.ndarray, "chains draws n"]
) -> Agreement:
    """Compare means, standard deviations and the ends of 95 % intervals.

    Args:
        one: Chains of a sampler.
        other: Of another.
    """
    first, second = _summary(one), _summary(other)
    apart = first[0] - second[0]
    sd = 0.5 * (first[0][1] + second[0][1])
    return Agreement(apart / np.hypot(first[1], second[1]), apart / sd)


def _summary(chains: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Statistics [4, n] and their Monte Carlo standard errors."""
    flat = chains.reshape(-1, chains.shape[2])
    value = np.stack([flat.mean(axis=0), flat.std(axis=0), *np.quantile(flat, ENDS, axis=0)])
    error = np.empty_like(value)
    for k in range(chains.shape[2]):
        one = chains[:, :, k]
        error[:, k] = [
            array_stats.mcse(one, chain_axis=0, draw_axis=1, method="mean"),
            array_stats.mcse(one, chain_axis=0, draw_axis=1, method="sd"),
            *(
                array_stats.mcse(one, chain_axis=0, draw_axis=1, method="quantile", prob=p)
                for p in ENDS
            ),
        ]
    return value, error


def effective(chains: Float[np.ndarray, "chain draw n"]) -> tuple[float, float]:
    """Least bulk and least tail ESS of the quantities."""

    def least(**kind: Any) -> float:
        return min(
            float(np.asarray(array_stats.ess(chains[:, :, k], chain_axis=0, draw_axis=1, **kind)))
            for k in range(chains.shape[2])
        )

    return least(method="bulk"), least(method="tail", prob=TAILS)
