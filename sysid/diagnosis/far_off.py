"""Is a base so far off that what it leaves is no small error with a covariance?

Either its laws are wrong by a tenth of the force; or something else that large is missing, as a
preload, and Σ does not hold the fit.  Its sizes may grow with all that a base leaves, and under a
large Σ a fit explains details at the reversals and leaves to errors of the laws what least squares
would fit.  The size that an effect has in such a fit is far from what the loops show, and what it
gains is no evidence.  A preload alone does no harm: beside right laws the fit stays where it is.
"""

from typing import Final

import jax.numpy as jnp

from sysid.diagnosis.bases import Base, with_error_models
from sysid.diagnosis.coarse import COARSE
from sysid.diagnosis.state import settle
from sysid.likelihood.reml import TIMES
from sysid.models.coordinates import valve_at

ASTRAY: Final = TIMES
"""Error of the fit under Σ, in that of least squares, beyond which Σ does not hold it; what is
constant through a test left out of both.  Errors of a valve's laws may not exceed that either."""


def far_off(base: Base) -> bool:
    """Effects are to be sought by least squares and tests not seen, without Σ.

    Args:
        base: The base.
    """
    if base.in_sample > COARSE:
        return True
    return _whole(base) > COARSE and _astray(base)


def _whole(base: Base) -> float:
    """Error of the base, what is constant through a test counted, parts of max|F|."""
    damper = valve_at(base.free.coordinates, jnp.asarray(base.free.u))
    return float(base.evidence.errors(damper).mean())


def _astray(base: Base) -> bool:
    """The fit under Σ is far from the loops."""
    evidence = with_error_models((base,))[0].evidence
    state = settle(evidence, base.free.coordinates, base.free.u)
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    error = evidence.errors(damper, offset=False).mean()
    return bool(error > ASTRAY * base.in_sample)
