"""Least squares with weights 1/max|F|: the fit whose free run errs least, test by test."""

from dataclasses import replace
from typing import Final

import numpy as np

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.state import State
from sysid.likelihood.discrepancy import NAMES, Covariance, Sizes
from sysid.likelihood.gls import GlsFit, gauss_newton
from sysid.likelihood.reml import Restricted
from sysid.models.damper_coordinates import DamperCoordinates

NONE: Final = Sizes(gain=0.0, offset=0.0, delay=0.0, odd=0.0, even=0.0)
STEPS: Final = 40
UNIT: Final = 1e-3
"""Standard deviation that every harmonic is given, parts of max|F|: so small that a fit which has
converged in its terms has converged."""
INDEPENDENT: Final = 4.0
"""Independent numbers a loop, one for each parity: neighbouring points err alike."""


def unweighted(evidence: Evidence) -> Evidence:
    """The same campaign with errors that are independent and proportional to max|F|."""
    parts = evidence.parts
    plain = replace(parts, noise=UNIT * evidence.peak, laws=np.zeros((0, *parts.force.shape)))
    return replace(evidence, parts=plain)


def plainly_fitted(
    evidence: Evidence,
    coordinates: DamperCoordinates,
    u: np.ndarray,
    steps: int = STEPS,
    tolerance: float = 1e-7,
) -> State:
    """Least squares with weights 1/max|F|.

    The likelihood is that of errors of unknown size, `INDEPENDENT` numbers a loop.

    Args:
        evidence: The campaign, `unweighted`.
        coordinates: Map from u to the damper.
        u: [n] start.
        steps: Gauss–Newton steps at most.
        tolerance: Of `gauss_newton`.
    """
    covariance = Covariance(evidence.parts, NONE)

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return evidence.look(coordinates, z)

    gls = gauss_newton(look, u, covariance, max_steps=steps, tolerance=tolerance)
    return State(coordinates, _scaled(gls, evidence), _unit(covariance), _likelihood(gls, evidence))


def plain_distance(before: State, one: State, other: State) -> float:
    """√(n |Δ|² / |r|²): how far two predictions are apart, in standard errors.

    Δ is their difference and r what the model without either leaves, tests weighted by 1/max|F|;
    n counts `INDEPENDENT` numbers a loop.

    Args:
        before: The model, `plainly_fitted`.
        one: It with one effect.
        other: It with another.

    Returns:
        Without unit, as `Contender.apart`.
    """
    difference = (one.gls.residual - other.gls.residual)[:, :, None]
    share = float(before.covariance.inner(difference, difference)[0, 0]) / before.gls.cost
    return float(np.sqrt(INDEPENDENT * difference.shape[0] * max(share, 0.0)))


def _likelihood(gls: GlsFit, evidence: Evidence) -> float:
    return -0.5 * INDEPENDENT * evidence.tests * float(np.log(gls.cost / evidence.tests))


def _scaled(gls: GlsFit, evidence: Evidence) -> GlsFit:
    """Information in units of the residual that is left, so that its inverse is a covariance."""
    variance = gls.cost / (INDEPENDENT * evidence.tests)
    return replace(gls, information=gls.information / max(variance, 1e-300))


def _unit(covariance: Covariance) -> Restricted:
    return Restricted(NONE, covariance, 0.0, np.zeros(len(NAMES)))
