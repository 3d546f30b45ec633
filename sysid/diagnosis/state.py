"""A model fitted under the discrepancy covariance, whose sizes are fitted in turn."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.prototypes import FORCE
from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import TOLERANCE, GlsFit
from sysid.likelihood.reml import Restricted
from sysid.likelihood.settling import PASSES, log_likelihood, settled
from sysid.models.damper_coordinates import DamperCoordinates

BORNE_OUT: Final = 0.5
"""Part of a gain in likelihood that the restricted likelihood must gain as well: in campaigns of
many conditions it gains .95 and more of any gain that counts."""


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


def gained(after: State, before: State, force: float) -> float:
    """Log-likelihood that one model gains over another, each under its own Σ.

    The sizes of Σ are those of the restricted likelihood.  Where tests of one current leave laws in
    current open, a large error of the laws lies along what parameters do anyhow: there the two
    likelihoods part, and the unrestricted one gains by a hundred from sizes that hardly differ.
    What the restricted one does not bear out by half is not gained.

    It is that of an orthonormal basis of what parameters do, and each parameter more raises it by
    ln(force) when all forces grow alike: it is told as for a damper of `FORCE`.

    Args:
        after: The one.
        before: The other.
        force: N, RMS over the campaign.
    """
    plain = after.likelihood - before.likelihood
    restricted = after.restricted.log_likelihood - before.restricted.log_likelihood
    restricted -= (after.u.size - before.u.size) * float(np.log(force / FORCE))
    return restricted if restricted < BORNE_OUT * plain else plain


def settle(
    evidence: Evidence,
    coordinates: DamperCoordinates,
    u: Float[np.ndarray, " n"],
    covariance: Covariance | None = None,
    *,
    passes: int = PASSES,
    tolerance: float = TOLERANCE,
) -> State:
    """Fit by GLS and the sizes of Σ by REML, in turns.

    Args:
        evidence: The campaign.
        coordinates: Map from u to the damper.
        u: [n] start.
        covariance: Σ for the first fit; from the residual at the start if None.
        passes: Turns.
        tolerance: Of the fits (`gauss_newton`).
    """
    gls, restricted = settled(
        evidence, coordinates, u, covariance, passes=passes, tolerance=tolerance
    )
    return State(coordinates, gls, restricted, log_likelihood(gls, restricted.covariance))
