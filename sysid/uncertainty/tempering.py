r"""To which power a likelihood must be raised to be as sure as clusters of tests agree.

With H the information, and s_c the score of cluster c (a condition, or a test) at the estimate,

    β = n / tr(H⁻¹ S),   S = Σ_c (I − H_c H⁻¹)^−½ s_c s_cᵀ (I − H⁻¹ H_c)^−½

The scores themselves are too small: the estimate has taken up part of each cluster's error, the
more, the more of what is known of a direction one cluster holds.  The factors make S what it
should be where the likelihood is right.

Source:
    The magnitude adjustment of a composite likelihood: Ribatet, Cooley and Davison, Statistica
    Sinica 22 (2012), Eq. 2.5; scores of clusters: "CR2" of Bell and McCaffrey, Survey Methodology
    28 (2002).
"""

from typing import Final

import numpy as np
from jaxtyping import Float, Int

from sysid.uncertainty.directions import directions_of

ALONE: Final = 1e-3
"""Part of the information on a direction that must lie outside of a cluster, or nothing tells
whether that cluster errs there: it counts as if the likelihood were right."""


def tempering(
    scores: Float[np.ndarray, "loop n"],
    curvatures: Float[np.ndarray, "loop n n"],
    cluster: Int[np.ndarray, " loop"],
) -> float:
    """β, at most 1.

    Args:
        scores: [L] of each test, JᵀΣ⁻¹r.
        curvatures: [L] JᵀΣ⁻¹J of each test.
        cluster: [L] number of each test's cluster.
    """
    axes = directions_of(curvatures.sum(axis=0)).seen
    inflation = 0.0
    for c in np.unique(cluster):
        own = cluster == c
        share, turned = np.linalg.eigh(axes.T @ curvatures[own].sum(axis=0) @ axes)
        left = 1.0 - share
        told = left > ALONE
        score = turned.T @ (axes.T @ scores[own].sum(axis=0))
        square = score**2 / np.where(told, left, 1.0)
        inflation += float(np.where(told, square, share).sum())
    inflation /= max(axes.shape[1], 1)
    return min(1.0, 1.0 / max(inflation, 1e-12))
