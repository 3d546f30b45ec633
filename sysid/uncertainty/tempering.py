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

import numpy as np
from jaxtyping import Float, Int

from sysid.uncertainty.directions import shares_of


def tempering(
    scores: Float[np.ndarray, "loop n"],
    curvatures: Float[np.ndarray, "loop n n"],
    cluster: Int[np.ndarray, " loop"],
) -> float:
    """β, at most 1.

    A direction that one cluster alone sees (`ALONE`) counts as if the likelihood were right.

    Args:
        scores: [L] of each test, JᵀΣ⁻¹r.
        curvatures: [L] JᵀΣ⁻¹J of each test.
        cluster: [L] number of each test's cluster.
    """
    own = [cluster == c for c in np.unique(cluster)]
    shares = shares_of(
        np.stack([curvatures[c].sum(axis=0) for c in own]),
        np.stack([scores[c].sum(axis=0) for c in own]),
    )
    terms = [np.where(s.told, s.over_rest(s.score**2), s.part) for s in shares]
    inflation = float(np.sum(terms)) / max(len(terms[0]), 1)
    return min(1.0, 1.0 / max(inflation, 1e-12))
