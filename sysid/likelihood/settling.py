"""Parameters by GLS and the sizes of Σ by REML, in turns."""

from dataclasses import replace
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import ROUNDING, TOLERANCE, Bound, GlsFit, gauss_newton
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
TIGHT: Final = 1.0
"""Errors of the laws that Σ may have at most, in `Parts.error`, where those of `TIMES` let the fit
go to its bound."""
AT: Final = 0.95
"""Part of what it may leave, RMS, from which a fit is at its bound."""


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
    fitted by least squares (`Parts.error`), or than at the start.  REML knows nothing of that: its
    sizes are those of what a fit without the bound would leave.  Where one ends at the bound, those
    of a smaller Σ, which holds its parameters, are taken from then on if they suit what is left
    better.

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
    start = observed.look(coordinates, u)
    bound = _bound(observed, start[0], coordinates.statics_free)
    last: GlsFit | None = None

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if last is not None and np.array_equal(z, last.u):  # where the fit before this one ended
            return last.residual, last.jacobian
        if np.array_equal(z, u):
            return start
        return observed.look(coordinates, z)

    if covariance is None:
        covariance = fit_sizes(observed.parts, *start).covariance
    times = TIMES

    def sizes_at(gls: GlsFit, near: Sizes | None = None) -> Restricted:
        nonlocal times
        found = fit_sizes(observed.parts, gls.residual, gls.jacobian, near, times=times)
        at_bound = bound.left(gls.residual) >= AT**2 * bound.most
        if times == TIGHT or not at_bound or _left(gls, found.covariance) < UNSETTLED:
            return found
        tight = fit_sizes(observed.parts, gls.residual, gls.jacobian, times=TIGHT)
        if log_likelihood(gls, tight.covariance) <= log_likelihood(gls, found.covariance):
            return found
        times = TIGHT
        return tight

    first = ON_THE_WAY if passes > 1 else tolerance
    gls = last = gauss_newton(look, u, covariance, bound=bound, tolerance=first)
    restricted = sizes_at(gls)
    for turn in range(1, passes + MORE):
        here = restricted.covariance
        if turn >= passes and _left(gls, here) < UNSETTLED:
            break
        before = gls
        gls = last = gauss_newton(look, before.u, here, bound=bound, tolerance=tolerance)
        restricted = sizes_at(gls, restricted.sizes)
        if turn >= passes - 1 and _gained(before, gls, here) < UNSETTLED:
            break  # whatever a linear step promises, the model or the bound does not let it
    return gls, restricted


def log_likelihood(gls: GlsFit, covariance: Covariance) -> float:
    """−½ (ln|Σ| + rᵀΣ⁻¹r) of a fit, a pure number up to a constant of the campaign.

    Args:
        gls: The fit.
        covariance: Σ.
    """
    r = gls.residual[:, :, None]
    return -0.5 * (covariance.log_determinant + float(covariance.inner(r, r)[0, 0]))


def _bound(observed: Observed, residual: Float[np.ndarray, "loop m"], statics_free: bool) -> Bound:
    """On the square of `Observed.relative`.

    Under a loose Σ parameters are hardly held: what they may leave has a bound, as errors of the
    laws have.
    """
    first = int(statics_free)
    weight = 1.0 / (observed.tests * np.sum(observed.measured[:, first:] ** 2, axis=1))
    bound = Bound(weight, (TIMES * observed.parts.error) ** 2, first)
    return replace(bound, most=max(bound.most, (1.0 + ROUNDING) * bound.left(residual)))


def _gained(before: GlsFit, after: GlsFit, covariance: Covariance) -> float:
    """Log-likelihood that a fit gained under the Σ that it was made with."""
    r = before.residual[:, :, None]
    return 0.5 * (float(covariance.inner(r, r)[0, 0]) - after.cost)


def _left(gls: GlsFit, covariance: Covariance) -> float:
    """Log-likelihood that a linear step of the parameters would gain under another Σ."""
    jacobian = full_rank(gls.jacobian)
    gram = covariance.inner(jacobian, np.concatenate([jacobian, gls.residual[:, :, None]], axis=2))
    information, slope = gram[:, :-1], gram[:, -1]
    return 0.5 * float(slope @ np.linalg.solve(information, slope))
