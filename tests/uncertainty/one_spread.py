"""How far an estimator is from the truth under one Σ, which is known or nearly so."""

import numpy as np

from sysid.likelihood.discrepancy import Parts, Sizes
from sysid.likelihood.plausible import Plausible
from sysid.uncertainty.spread import Spread, mean_spread


def spread_of(
    H: np.ndarray, weights: np.ndarray, parts: Parts, sizes: Sizes, unsure: np.ndarray | None = None
) -> Spread:
    """`mean_spread` over a single Σ.

    Args:
        H: [n, n] inverse of B.
        weights: [L, m, n] G.
        parts: What Σ is made of.
        sizes: Standard deviations of its parts.
        unsure: [name] standard deviations of their logarithms by REML; as good as known if None.
    """
    one = Plausible(1.0, parts.lengths, parts.kernel, sizes, unsure)
    return mean_spread(H, weights, parts, (one,))
