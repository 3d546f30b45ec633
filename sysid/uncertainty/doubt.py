r"""How much less certain a likelihood is for not knowing its covariance.

What the tests say of n parameters, to first order, are n numbers: with J the change of the loops
with the parameters, r the residual and WᵀW = Σ⁻¹,

    s = Xᵀ Σ⁻¹ r,   X = J R,   XᵀΣ⁻¹X = 1,

independent and of unit variance if errors have the covariance Σ, and of the covariance

    S_k = Gᵀ Σ_k G,   G = Σ⁻¹X

if they have Σ_k.  The likelihood is that of s averaged over Σ_k that may be right, times what Σ
says of all the rest of r:

    ln L = −½ rᵀΣ⁻¹r + ½ sᵀs + ln Σ_k w_k |S_k|^−½ exp(−½ sᵀS_k⁻¹s)

The Σ_k have the correlation lengths that may be right as well (`likelihood.plausible`), each as
often as it is probable, and sizes s_i that scatter as much as REML and `OF_SHAPE` let them be
unknown: s_i² ν/χ²_ν with ν = 1/(2 sd²), sd the standard deviation of ln s_i, without far tails.
For a linear model marginals are nearly the t distributions of `spread`.

Source:
    Scale mixtures and Student's t: Andrews and Mallows, Journal of the Royal Statistical Society B
    36 (1974).  Low-discrepancy draws: Sobol', USSR Computational Mathematics and Mathematical
    Physics 7 (1967).
"""

from dataclasses import dataclass
from typing import Any, Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.special import chdtri
from scipy.stats.qmc import Sobol

from sysid.likelihood.carried import carried
from sysid.likelihood.discrepancy import NAMES
from sysid.likelihood.plausible import Plausible
from sysid.models.coordinates import AbstractCoordinates
from sysid.uncertainty.directions import directions_of
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.spread import LEAST_FREEDOM, unsure

MEMBERS: Final = 64
"""Σs that are averaged over; a power of two, as Sobol's sequence wants it."""
WITHIN: Final = 0.95
"""Central part of each size's distribution that is drawn from.  Walkers hardly come back from the
tails of the few largest (autocorrelation times of 300 instead of 20 steps); without them intervals
of 95 % are still as wide as those of the t distributions, where a hundred tests tell the sizes."""
KNOWN: Final = 1e-3
"""Standard deviation of ln size below which a size is as good as known."""


class Mixture(eqx.Module):
    """How probable s is under all Σ_k, beside Σ.

    Attributes:
        root: [n, k, n] R_k with S_k⁻¹ = R_k R_kᵀ, side by side.
        weight: [k] ln w_k − ½ ln|S_k|, so that s = 0 is worth nothing.
    """

    root: Float[Array, "n k n"]
    weight: Float[Array, " k"]

    def __call__(self, s: Float[Array, " n"]) -> Float[Array, ""]:
        """What ln L is more than −½ rᵀΣ⁻¹r."""
        white = jnp.tensordot(s, self.root, axes=1)
        each = self.weight - 0.5 * jnp.sum(white**2, axis=1)
        return jax.nn.logsumexp(each) + 0.5 * jnp.sum(s**2)


@dataclass(frozen=True)
class Doubt:
    """Σs that may be right, and what tells between them.

    Attributes:
        weights: [L, m, n] G; n = 0 where Σ is taken for known.
        mixture: Of s.
    """

    weights: Float[np.ndarray, "loop m n"]
    mixture: Mixture

    def of(self, residual: Float[np.ndarray, "draw loop m"]) -> Float[np.ndarray, " draw"]:
        """What ln L is more than −½ rᵀΣ⁻¹r, for residuals.

        Args:
            residual: [D, L, m] N.
        """
        s = np.einsum("lmn,dlm->dn", self.weights, residual)
        return np.asarray(_all(self.mixture, jnp.asarray(s)))


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
        return Doubt(np.zeros((*parts.force.shape, 0)), _mixture(np.zeros((1, 0, 0))))
    _, jacobian = errors.observed.look(coordinates, errors.u)
    X = jacobian @ directions_of(errors.covariance.inner(jacobian, jacobian)).seen
    G = errors.covariance.weighted(X)
    return Doubt(G, _mixture(_members(errors, G)))


def _members(errors: ErrorModel, G: Float[np.ndarray, "loop m n"]) -> Float[np.ndarray, "k n n"]:
    """S_k: Σs by their weight, with sizes as unknown as they are."""
    believed = errors.believed()
    at = Sobol(1 + len(NAMES), rng=np.random.default_rng(0)).random(MEMBERS)
    shares = np.cumsum([one.weight for one in believed])
    chosen = np.minimum(np.searchsorted(shares, at[:, 0]), len(believed) - 1)
    found = np.empty((MEMBERS, G.shape[2], G.shape[2]))
    for number in np.unique(chosen):
        one, own = believed[number], chosen == number
        origin = carried(one.of(errors.observed.parts), one.sizes, G)
        factors = np.concatenate([np.ones((own.sum(), 1)), _factors(one, at[own, 1:])], axis=1)
        found[own] = np.einsum("ki,inm->knm", factors, origin)
    return found


def _factors(one: Plausible, at: Float[np.ndarray, "k name"]) -> Float[np.ndarray, "k name"]:
    """Of the squares of its sizes, at places of the unit cube."""
    sd = unsure(one)
    freedom = np.maximum(0.5 / np.maximum(sd, KNOWN) ** 2, LEAST_FREEDOM)
    at = 0.5 + WITHIN * (at - 0.5)
    return np.where(sd > KNOWN, freedom / chdtri(freedom, at), 1.0)


def _mixture(members: Float[np.ndarray, "k n n"]) -> Mixture:
    """Of normal distributions of zero mean, all as likely."""
    lower = np.linalg.cholesky(members)
    n = members.shape[1]
    root = np.swapaxes(np.linalg.solve(lower, np.broadcast_to(np.eye(n), members.shape)), 1, 2)
    weight = -np.sum(np.log(np.diagonal(lower, axis1=1, axis2=2)), axis=1)
    weight -= np.logaddexp.reduce(weight)
    return Mixture(jnp.asarray(np.moveaxis(root, 0, 1)), jnp.asarray(weight))


@eqx.filter_jit
def _all(mixture: Mixture, s: Array) -> Array:
    return jax.vmap(mixture)(s)
