"""What an effect leaves whose formula acts alike in both directions, when the damper's does not.

A lip that grips one way, a valve that closes one way: beside the formula F_e they leave a part of
F_e·sgn v, and other effects look like that.  What a candidate explains of it is no evidence for the
candidate.
"""

from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.diagnosis.absorbed import products
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.signatures import signatures
from sysid.diagnosis.state import State
from sysid.models.coordinates import valve_at

CARRIES: Final = frozenset({"force_offset"})
"""Effects by which a model carries one-sided friction; `one_sided` judges whether they are more."""


def one_way(evidence: Evidence, state: State) -> Float[np.ndarray, "loop m effect"]:
    """F_e·sgn v of every effect that a model has, N per unit of its size.

    Args:
        evidence: The campaign.
        state: The model, fitted.
    """
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    if not damper.effects:
        return np.zeros((*state.gls.residual.shape, 0))
    directions = np.sign(np.asarray(evidence.motion.velocity))
    return signatures(evidence, damper.valve, damper.effects, directions)


def share_of_its_own(
    signature: Float[np.ndarray, "loop m"],
    one_way: Float[np.ndarray, "loop m effect"],
    state: State,
) -> float:
    """Part of a candidate's score that stays where any of these may be in what the model leaves.

    Args:
        signature: [L, m] N per unit, of the candidate.
        one_way: [L, m, k] N per unit.
        state: The model that it is added to.

    Returns:
        0 to 1; 1 where the model has no effects.
    """
    if one_way.shape[2] == 0:
        return 1.0
    gls = state.gls
    both = np.stack([signature, gls.residual], axis=2)
    known = (gls.jacobian, np.concatenate([gls.jacobian, one_way], axis=2))
    score = []
    for jacobian in known:
        rest = products(both, jacobian, state.covariance).after
        score.append(rest[0, 1] ** 2 / rest[0, 0] if rest[0, 0] > 0.0 else 0.0)
    return min(1.0, score[1] / score[0]) if score[0] > 0.0 else 1.0
