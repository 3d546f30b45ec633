r"""How far an estimator is from the truth under a covariance that is itself estimated.

An estimator moves by δ = B Σ_l G_lᵀ e_l when the loops err by e, so with the covariance Σ of such
errors

    cov = B (Gᵀ Σ G) B

Σ is known no better than its sizes s_i: of the variance V of a parameter V_i comes from each, the
standard deviation of ln s_i is known, Var(V) = 4 Σ_i V_i² sd_i², and V has 2V²/Var(V) degrees of
freedom for Student's t.  Sizes of smooth errors are known less well than REML says, which takes the
shape of their covariance over conditions for granted and their finest detail for evidence.  How
smooth errors of the laws are is not known either: V is averaged over what may be right
(`likelihood.plausible`), and the interval is that of the mixture of their t distributions.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.identification.result import Fit
from sysid.likelihood.carried import carried
from sysid.likelihood.discrepancy import NAMES, RIG
from sysid.likelihood.discrepancy_parts import Parts
from sysid.likelihood.plausible import Plausible
from sysid.models.base import AbstractValve
from sysid.models.coordinates import AbstractCoordinates, valve_at
from sysid.parameters import ParamSpec, specs, values
from sysid.uncertainty.covariance import LEVEL, magnitude_of
from sysid.uncertainty.declared import Declared
from sysid.uncertainty.directions import directions_of
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.mixture import half_width

OF_SHAPE: Final = 0.2
"""Standard deviation of ln size of smooth errors beside what REML says: what another shape of K_c
than Σ's makes of them (`benchmarks/law_sizes.py`)."""
LARGEST_SLOPE: Final = 1e140
"""N; its square and the sums of such are numbers yet."""
LEAST_FREEDOM: Final = 3.0
"""Degrees of freedom: of fewer, the formula for them knows nothing."""


@dataclass(frozen=True)
class Spread:
    """How far an estimator is from the truth, in relative changes of the parameters.

    Attributes:
        covariance: [n, n].
        plain: [n] diagonal of B alone.
        quantile: [n] half width of a 95 % interval in standard deviations.
    """

    covariance: Float[np.ndarray, "n n"]
    plain: Float[np.ndarray, " n"]
    quantile: Float[np.ndarray, " n"]


@dataclass(frozen=True)
class Place:
    """A model, and its free parameters.

    Attributes:
        valve: The model.
        declared: [n] of the free parameters.
        relative: Map from their relative changes to the model.
        theta: [n] their values.
        magnitude: [n] what a relative change of one is.
    """

    valve: AbstractValve
    declared: tuple[ParamSpec, ...]
    relative: Declared
    theta: Float[np.ndarray, " n"]
    magnitude: Float[np.ndarray, " n"]

    def sd(self, spread: Spread) -> Float[np.ndarray, " n"]:
        """Standard deviations in the parameters' units."""
        return self.magnitude * np.sqrt(np.diagonal(spread.covariance))


def place_at(coordinates: AbstractCoordinates[Any], u: Float[np.ndarray, " n"]) -> Place:
    """The model at some parameters.

    Args:
        coordinates: Map from u to the model.
        u: [n].
    """
    valve = valve_at(coordinates, jnp.asarray(u))
    free = coordinates.free
    chosen = [(s, float(v)) for s, v in zip(specs(valve), np.asarray(values(valve)), strict=True)]
    declared = tuple(s for s, _ in chosen if s.symbol in free)
    theta = np.array([v for s, v in chosen if s.symbol in free])
    magnitude = magnitude_of(theta, declared)
    return Place(valve, declared, Declared.beside(valve, coordinates, magnitude), theta, magnitude)


def spread_under(fit: Fit, errors: ErrorModel) -> tuple[Place, Spread]:
    """Of generalised least squares under Σ, at the most probable parameters.

    Args:
        fit: The fit, for its coordinates.
        errors: Σ, and the parameters that are most probable under it.
    """
    place = place_at(fit.coordinates, errors.u)
    _, jacobian = errors.observed.look(place.relative, np.zeros(place.relative.size))
    jacobian = known_slopes(jacobian)
    information = errors.covariance.inner(jacobian, jacobian)
    seen = errors.covariance.weighted(jacobian)
    return place, mean_spread(information, seen, errors.observed.parts, errors.believed())


def known_slopes(jacobian: Float[np.ndarray, "loop m n"]) -> Float[np.ndarray, "loop m n"]:
    """The same, zero for parameters whose slopes are no numbers that could be squared.

    A fit that failed may have left a parameter where the force's change with it overflows; of such
    a one nothing is known, as of one that does nothing.

    Args:
        jacobian: [L, m, n].
    """
    sound = np.abs(jacobian).max(axis=(0, 1), initial=0.0) < LARGEST_SLOPE  # false for NaN
    return np.where(sound, jacobian, 0.0)


def mean_spread(
    H: Float[np.ndarray, "n n"],
    weights: Float[np.ndarray, "loop m n"],
    parts: Parts,
    believed: Sequence[Plausible],
) -> Spread:
    """Covariance of an estimator, averaged over Σs that may be right, and how well it is known.

    Args:
        H: Inverse of B; directions that it does not see get a standard deviation of 10⁴.
        weights: [L, m, n] G.
        parts: What one of them is made of; all but K_c is common to them.
        believed: Each Σ, with its weight.

    Source:
        Degrees of freedom: Satterthwaite, Biometrics Bulletin 2 (1946); with REML: Giesbrecht and
        Burns, Biometrics 41 (1985).  The sizes' errors are taken to be independent.
    """
    seen, unseen = directions_of(H)
    bread = seen @ seen.T
    covariance, deviations, freedoms = unseen @ unseen.T, [], []
    unknown = np.maximum(np.diagonal(covariance), 1e-300)
    for one in believed:
        origin = bread @ carried(one.of(parts), one.sizes, weights) @ bread
        covariance = covariance + one.weight * origin.sum(axis=0)
        share = np.diagonal(origin, axis1=1, axis2=2)
        variance = share.sum(axis=0) + unknown
        doubt = 2.0 * np.sum((share[1:] / variance * _unsure(one)[:, None]) ** 2, axis=0)
        freedoms.append(np.maximum(1.0 / np.maximum(doubt, 1e-12), LEAST_FREEDOM))
        deviations.append(np.sqrt(variance))
    weight = np.array([one.weight for one in believed])
    half = half_width(weight, np.array(deviations), np.array(freedoms), LEVEL)
    quantile = half / np.sqrt(np.maximum(np.diagonal(covariance), 1e-300))
    return Spread(covariance, np.diagonal(bread), quantile)


def _unsure(one: Plausible) -> Float[np.ndarray, " name"]:
    """Standard deviations of the logarithms of its sizes; zero where they are as good as known."""
    if one.spread is None:
        return np.zeros(len(NAMES))
    return np.hypot(one.spread, np.where(np.isin(NAMES, RIG), 0.0, OF_SHAPE))
