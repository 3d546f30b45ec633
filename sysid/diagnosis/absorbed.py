"""What the parameters of a model can absorb, and what is left of a signal."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.reml import full_rank


class Products(NamedTuple):
    """Products of k signals.

    Attributes:
        before: [k, k] aᵀΣ⁻¹b.
        after: [k, k] aᵀPb, P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹: without what the model absorbs.
    """

    before: Float[np.ndarray, "k k"]
    after: Float[np.ndarray, "k k"]


def products(
    signals: Float[np.ndarray, "loop m k"],
    jacobian: Float[np.ndarray, "loop m n"],
    covariance: Covariance,
) -> Products:
    """Whitened products of signals, before and after removal of what a model absorbs.

    Args:
        signals: [L, m, k]; values that are not finite count as zero.
        jacobian: [L, m, n] of the model, of any rank.
        covariance: Σ.
    """
    solid = full_rank(jacobian)
    n = solid.shape[2]
    every = np.concatenate([solid, signals], axis=2)
    every = np.where(np.isfinite(every), every, 0.0)
    gram = covariance.inner(every, every)
    absorbed = gram[n:, :n] @ np.linalg.solve(gram[:n, :n], gram[:n, n:])
    return Products(gram[n:, n:], gram[n:, n:] - absorbed)


def likeness(
    a: Float[np.ndarray, "loop m"],
    b: Float[np.ndarray, "loop m"],
    jacobian: Float[np.ndarray, "loop m n"],
    covariance: Covariance,
) -> float:
    """cos² between two signatures after whitening and removal of what the model absorbs."""
    rest = products(np.stack([a, b], axis=2), jacobian, covariance).after
    scale = rest[0, 0] * rest[1, 1]
    return float(rest[0, 1] ** 2 / scale) if scale > 0.0 else 0.0
