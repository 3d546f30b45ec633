r"""How much less certain a likelihood is for not knowing its covariance.

What the tests say of n parameters, to first order, are n numbers: with J the change of the loops
with relative changes of the parameters, H = JᵀΣ⁻¹J and r the residual,

    s = Xᵀ Σ⁻¹ r,   X = J R,   RᵀHR = 1,

independent and of unit variance if errors have the covariance Σ.  If they have any of the Σ_k that
may be right (`ErrorModel.believed`), of the covariance S = Σ_k w_k Gᵀ Σ_k G, G = Σ⁻¹X, on average.
Along the axes of S, S = V diag(v) Vᵀ, they are independent again; sizes of Σ_k are estimated, so
an interval along axis j is q_j / 1.96 times wider yet, q_j its quantile of Student's t (`spread`).
The likelihood is that of s with all this, times what Σ says of all the rest of r:

    ln L = −½ rᵀΣ⁻¹r + ½ sᵀs − ½ sᵀS̃⁻¹s,   S̃ = V diag(v_j (q_j / 1.96)²) Vᵀ

Each axis is widened by itself: of parameters that trade with each other one must not be widened
more than the other, or what is known of both together would be lost.  Tails further out are those
of a normal density: under a mixture of all Σ_k, which has the tails of t, walkers hardly came back
from them (autocorrelation times of 300 instead of 10).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from sysid.models.coordinates import AbstractCoordinates
from sysid.uncertainty.covariance import NORMAL
from sysid.uncertainty.directions import directions_of
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.spread import Spread, mean_spread, place_at


@dataclass(frozen=True)
class Doubt:
    """What a likelihood makes of its covariance not being known.

    Attributes:
        weights: [L, m, n] G; n = 0 where Σ is taken for known.
        root: [n, n] B with S̃⁻¹ = B Bᵀ.
    """

    weights: Float[np.ndarray, "loop m n"]
    root: Float[np.ndarray, "n n"]

    def of(self, residual: Float[np.ndarray, "draw loop m"]) -> Float[np.ndarray, " draw"]:
        """What ln L is more than −½ rᵀΣ⁻¹r.

        Args:
            residual: [D, L, m] N.
        """
        s = np.einsum("lmn,dlm->dn", self.weights, residual)
        return 0.5 * np.sum(s**2, axis=1) - 0.5 * np.sum((s @ self.root) ** 2, axis=1)


def doubt_of(coordinates: AbstractCoordinates[Any], errors: ErrorModel) -> Doubt:
    """What is not known of the covariance of a likelihood.

    Only the full likelihood has errors whose sizes were found by REML against other smooth errors;
    every other takes what it has for known.

    Args:
        coordinates: Map from u to the model.
        errors: The likelihood.
    """
    parts = errors.observed.parts
    if errors.kind != "full" or errors.spread is None:
        return Doubt(np.zeros((*parts.force.shape, 0)), np.zeros((0, 0)))
    relative = place_at(coordinates, errors.u).relative
    _, jacobian = errors.observed.look(relative, np.zeros(relative.size))
    R = directions_of(errors.covariance.inner(jacobian, jacobian)).seen
    G = errors.covariance.weighted(jacobian @ R)

    def along(axes: Float[np.ndarray, "n n"]) -> Spread:
        return mean_spread(np.eye(len(axes)), G @ axes, parts, errors.believed())

    V = np.linalg.eigh(along(np.eye(G.shape[2])).covariance)[1]
    spread = along(V)
    return Doubt(G, V / (spread.quantile / NORMAL * np.sqrt(np.diagonal(spread.covariance))))
