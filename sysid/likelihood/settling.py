"""Parameters by GLS and the sizes of Σ by REML, in turns."""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.gls import TOLERANCE, GlsFit, gauss_newton
from sysid.likelihood.observed import Observed
from sysid.likelihood.reml import TIMES, Restricted, fit_sizes, full_rank
from sysid.models.coordinates import AbstractCoordinates

PASSES: Final = 2
MORE: Final = 3
"""Further turns at most, where the parameters are not yet those of the last Σ."""
UNSETTLED: Final = 1.0
"""Log-likelihood that a linear step of the parameters would still gain under it."""
ON_THE_WAY: Final = 1e-2
"""Tolerance of the fit under a Σ that is not the last: a tenth of a standard error."""


def settled(
    observed: Observed,
    coordinates: AbstractCoordinates,
    u: Float[np.ndarray, " n"],
    covariance: Covariance | None = None,
    *,
    passes: int = PASSES,
    tolerance: float = TOLERANCE,
) -> tuple[GlsFit, Restricted]:
    """Fit by GLS and the sizes of Σ by REML, in turns.

    No parameters are taken with which the model leaves more than `TIMES` what it leaves when it is
    fitted by least squares (`Parts.error`), or than at the start.

    Args:
        observed: Measured loops.
        coordinates: Map from u to the model.
        u: [n] start.
        covariance: Σ for the first fit; from the residual at the start if None.
        passes: Turns.
        tolerance: Of the fits (`gauss_newton`), but for the first of several.

    Returns:
        The last fit, and the sizes of Σ at it.
    """
    # under a loose Σ parameters are hardly held: what they may leave has a bound, as errors of the
    # laws have; the first look, at the start, tells what they leave there
    farthest: float | None = None
    last: GlsFit | None = None

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nonlocal farthest
        if last is not None and np.array_equal(z, last.u):  # where the fit before this one ended
            return last.residual, last.jacobian
        residual, jacobian = observed.look(coordinates, z)
        left = observed.relative(residual)
        if farthest is None:
            farthest = max(TIMES * observed.parts.error, left)
        if left > farthest:
            residual = np.full_like(residual, np.inf)
        return residual, jacobian

    if covariance is None:
        covariance = fit_sizes(observed.parts, *look(u)).covariance
    first = ON_THE_WAY if passes > 1 else tolerance
    gls = last = gauss_newton(look, u, covariance, tolerance=first)
    restricted = fit_sizes(observed.parts, gls.residual, gls.jacobian)
    for _ in range(passes - 1):
        gls = last = gauss_newton(look, gls.u, restricted.covariance, tolerance=tolerance)
        restricted = fit_sizes(observed.parts, gls.residual, gls.jacobian, restricted.sizes)
    for _ in range(MORE):
        if _left(gls, restricted.covariance) < UNSETTLED:
            break
        gls = last = gauss_newton(look, gls.u, restricted.covariance, tolerance=tolerance)
        restricted = fit_sizes(observed.parts, gls.residual, gls.jacobian, restricted.sizes)
    return gls, restricted


def _left(gls: GlsFit, covariance: Covariance) -> float:
    """Log-likelihood that a linear step of the parameters would gain under another Σ."""
    jacobian = full_rank(gls.jacobian)
    gram = covariance.inner(jacobian, np.concatenate([jacobian, gls.residual[:, :, None]], axis=2))
    information, slope = gram[:, :-1], gram[:, -1]
    return 0.5 * float(slope @ np.linalg.solve(information, slope))
