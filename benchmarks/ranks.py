r"""Are ranks uniform: the test of simulation-based calibration.

If parameters are drawn from the prior, data from the model, and L draws from the posterior, the
rank of the parameter among the draws is uniform on 0 … L.  The empirical distribution function of N
such ranks, at each z, is a binomial count; the test takes the least probable of them,

    γ(ranks) = min_z 2 min{ P(Bin(N, z) ≤ N F̂(z)),  P(Bin(N, z) ≥ N F̂(z)) }

and its p-value is the share of samples of uniform ranks with a γ no larger.

Source:
    Säilynoja, Bürkner and Vehtari, Statistics and Computing 32 (2022): the simultaneous band;
    Talts, Betancourt, Simpson, Vehtari and Gelman, arXiv 1804.06788 (2018): the ranks.
"""

from functools import cache
from typing import Final

import numpy as np
from jaxtyping import Float, Int
from scipy.stats import binom

SIMULATIONS: Final = 4000
PLACES: Final = 50
"""At most so many z are looked at."""


def rank(draws: Float[np.ndarray, "draw n"], truth: Float[np.ndarray, " n"]) -> list[int]:
    """Draws below the truth, of each quantity."""
    return [int(k) for k in np.sum(draws < truth, axis=0)]


def p_value(ranks: Int[np.ndarray, " campaign"], draws: int) -> float:
    """Probability of ranks as far from uniform as these, were they uniform.

    Args:
        ranks: 0 … L each.
        draws: L.
    """
    null = _null(len(ranks), draws)
    return float((1.0 + np.sum(null <= _gamma(ranks[None], draws)[0])) / (len(null) + 1.0))


def band(
    campaigns: int, draws: int, level: float = 0.95
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where F̂ lies as a whole with the probability of the level: z, low, high.

    Args:
        campaigns: N.
        draws: L.
        level: Of the band.
    """
    gamma = float(np.quantile(_null(campaigns, draws), 1.0 - level))
    z = _places(draws)
    low, high = binom.ppf([[gamma / 2.0], [1.0 - gamma / 2.0]], campaigns, z) / campaigns
    return z, low, high


def _places(draws: int) -> np.ndarray:
    """z: the shares of ranks below k, for some k."""
    k = np.unique(np.linspace(1, draws, min(PLACES, draws)).astype(int))
    return k / (draws + 1.0)


def _gamma(ranks: np.ndarray, draws: int) -> np.ndarray:
    """γ of each row of ranks."""
    z, count = _places(draws), ranks.shape[1]
    k = np.round(z * (draws + 1.0)).astype(int)
    below = np.sum(ranks[:, :, None] < k, axis=1)
    either = np.minimum(binom.cdf(below, count, z), binom.sf(below - 1, count, z))
    return 2.0 * either.min(axis=1)


@cache
def _null(count: int, draws: int) -> np.ndarray:
    """γ of uniform ranks."""
    rng = np.random.default_rng([count, draws])
    return np.concatenate(
        [
            _gamma(rng.integers(0, draws + 1, size=(SIMULATIONS // 8, count)), draws)
            for _ in range(8)
        ]
    )
