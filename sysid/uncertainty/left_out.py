"""Each condition predicted by the model fitted to the others."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from jaxtyping import Float, Int

from sysid.identification.conditions import conditions
from sysid.likelihood.discrepancy import Covariance, covariance_parts
from sysid.likelihood.gls import gauss_newton
from sysid.models.coordinates import AbstractCoordinates
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.force_draws import force_draws
from sysid.uncertainty.target import motion_of

STEPS: Final = 6
"""Gauss–Newton steps from the fit to all tests towards that without some of them."""
TOLERANCE: Final = 1e-2
"""Of these fits: parameters within a tenth of their standard errors."""


def static_force(
    measured: Float[np.ndarray, "loop point"], predicted: Float[np.ndarray, "loop point"]
) -> Float[np.ndarray, "loop 1"]:
    """[L, 1] N, of each test beside a model that has none."""
    return np.mean(measured - predicted, axis=1, keepdims=True)


@dataclass(frozen=True)
class LeftOut:
    """Predictions of tests by models that have not seen their condition.

    Attributes:
        condition: [L] number of each test's (amplitude, frequency), from 0.
        u: [C, n] parameters fitted without each condition.
        predicted: [L, P] N.
        measured: [L, P] N, without a static force of the test where the model leaves that free:
            `predicted` has none.
        noise: N, of a point of a measured loop, in the middle of all tests.
    """

    condition: Int[np.ndarray, " loop"]
    u: Float[np.ndarray, "condition n"]
    predicted: Float[np.ndarray, "loop point"]
    measured: Float[np.ndarray, "loop point"]
    noise: float


def leave_conditions_out(errors: ErrorModel, coordinates: AbstractCoordinates[Any]) -> LeftOut:
    """Fit a campaign without each of its conditions in turn, under the same sizes of Σ.

    Args:
        errors: The likelihood, on the tests of the campaign.
        coordinates: Map from u to the model.
    """
    observed = errors.observed
    condition = conditions(observed.loops)
    places = []
    for number in range(int(condition.max()) + 1):
        kept = condition != number
        if not kept.any():
            places.append(errors.u)
            continue

        def look(u: np.ndarray, kept: np.ndarray = kept) -> tuple[np.ndarray, np.ndarray]:
            residual, jacobian = observed.look(coordinates, u)
            return residual[kept], jacobian[kept]

        covariance = Covariance(observed.parts.of(kept), errors.sizes)
        gls = gauss_newton(look, errors.u, covariance, max_steps=STEPS, tolerance=TOLERANCE)
        places.append(gls.u)
    u = np.stack(places)
    motion = motion_of(observed)
    every = force_draws(coordinates, u, motion)
    own = every[condition, np.arange(len(condition))]
    measured = observed.force
    if coordinates.statics_free:
        measured = measured - static_force(measured, own)
    # of the cycles: a likelihood without errors of the laws takes all that a model leaves for noise
    scatter = covariance_parts(observed.loops, observed.basis).noise
    noise = float(np.median(scatter) * np.sqrt(observed.loops.force.shape[1]))
    return LeftOut(condition, u, own, measured, noise)
