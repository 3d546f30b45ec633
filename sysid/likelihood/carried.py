"""What errors of each kind do to a weighted sum of the measured loops: Gᵀ Σ G, part by part."""

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import LAWS, NAMES, Parts, Sizes


def carried(
    parts: Parts, sizes: Sizes, weights: Float[np.ndarray, "loop m n"]
) -> Float[np.ndarray, "part n n"]:
    """Covariance of Σ_l G_lᵀ e_l, e the error of the loops, by its origin.

    Σ is a sum, so every part goes through on its own; nothing is solved or factorised, and any
    number of harmonics may be asked.

    Args:
        parts: What Σ is made of.
        sizes: Standard deviations.
        weights: [L, m, n] G.

    Returns:
        [1 + names, n, n]: of the noise, then of each size in the order of `NAMES`; zeros for what
        Σ does not have.
    """
    n = weights.shape[2]
    out = np.zeros((1 + len(NAMES), n, n))
    noisy = parts.noise[:, None, None] * weights
    out[0] = np.einsum("lmi,lmj->ij", noisy, noisy)
    for name, varying in zip(parts.rig, parts.modes.varying, strict=False):
        sums = getattr(sizes, name) * np.einsum("lm,lmi->li", varying, weights)
        out[1 + NAMES.index(name)] = sums.T @ sums
    scaled = parts.scale[:, None, None] * weights
    smooth = (parts.kernel @ scaled.reshape(len(scaled), -1)).reshape(scaled.shape)
    for name, rolled in zip(("odd", "even"), parts.modes.rolled, strict=True):
        both = np.einsum("lmi,m,lmj->ij", scaled, rolled, smooth)
        out[1 + NAMES.index(name)] = getattr(sizes, name) ** 2 * both
    for name, change in zip(LAWS, parts.laws, strict=False):
        sums = getattr(sizes, name) * np.einsum("lm,lmi->li", change, weights)
        out[1 + NAMES.index(name)] = sums.T @ parts.kernel @ sums
    return out
