"""A model fitted under the discrepancy covariance, whose sizes are fitted in turn."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.evidence import Evidence
from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import GlsFit, gauss_newton
from sysid.likelihood.reml import Restricted, fit_sizes, full_rank
from sysid.models.damper_coordinates import DamperCoordinates

PASSES: Final = 2
MORE: Final = 3
"""Further turns at most, where the parameters are not yet those of the last Σ."""
UNSETTLED: Final = 1.0
"""Log-likelihood that a linear step of the parameters would still gain under it."""


@dataclass(frozen=True)
class State:
    """A damper with its effects, fitted to a campaign.

    Attributes:
        coordinates: Map from u to the damper.
        gls: The fit.
        restricted: Sizes of Σ, by REML at this fit, and Σ.
        likelihood: Log-likelihood of the fit under its own Σ, up to a constant of the campaign.
    """

    coordinates: DamperCoordinates
    gls: GlsFit
    restricted: Restricted
    likelihood: float

    @property
    def u(self) -> Float[np.ndarray, " n"]:
        """Solver coordinates."""
        return self.gls.u

    @property
    def covariance(self) -> Covariance:
        """Σ."""
        return self.restricted.covariance

    @property
    def sizes(self) -> Sizes:
        """Sizes of the parts of Σ."""
        return self.restricted.sizes

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of its effects."""
        return tuple(e.facts.id for e in self.coordinates.prototypes)


def settle(
    evidence: Evidence,
    coordinates: DamperCoordinates,
    u: Float[np.ndarray, " n"],
    covariance: Covariance | None = None,
    *,
    passes: int = PASSES,
) -> State:
    """Fit by GLS and the sizes of Σ by REML, in turns.

    Args:
        evidence: The campaign.
        coordinates: Map from u to the damper.
        u: [n] start.
        covariance: Σ for the first fit; from the residual at the start if None.
        passes: Turns.
    """

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return evidence.look(coordinates, z)

    if covariance is None:
        covariance = fit_sizes(evidence.parts, *look(u)).covariance
    gls = gauss_newton(look, u, covariance)
    restricted = fit_sizes(evidence.parts, gls.residual, gls.jacobian)
    for _ in range(passes - 1):
        gls = gauss_newton(look, gls.u, restricted.covariance)
        restricted = fit_sizes(evidence.parts, gls.residual, gls.jacobian, restricted.sizes)
    for _ in range(MORE):
        if _left(gls, restricted.covariance) < UNSETTLED:
            break
        gls = gauss_newton(look, gls.u, restricted.covariance)
        restricted = fit_sizes(evidence.parts, gls.residual, gls.jacobian, restricted.sizes)
    r = gls.residual[:, :, None]
    cost = float(restricted.covariance.inner(r, r)[0, 0])
    likelihood = -0.5 * (restricted.covariance.log_determinant + cost)
    return State(coordinates, gls, restricted, likelihood)


def _left(gls: GlsFit, covariance: Covariance) -> float:
    """Log-likelihood that a linear step of the parameters would gain under another Σ."""
    jacobian = full_rank(gls.jacobian)
    gram = covariance.inner(jacobian, np.concatenate([jacobian, gls.residual[:, :, None]], axis=2))
    information, slope = gram[:, :-1], gram[:, -1]
    return 0.5 * float(slope @ np.linalg.solve(information, slope))
