"""Force of a damper model on a given motion."""

import equinox as eqx
from jaxtyping import Array, Float

from sysid.models.base import AbstractModel
from sysid.motion.motion import Motion


@eqx.filter_jit
def simulate(model: AbstractModel, motion: Motion) -> Float[Array, "*batch n"]:
    """Force at every point of a motion, in free run: nothing measured enters but the motion.

    Args:
        model: The model.
        motion: [..., n], from `loop_motion`, `sine_motion` or `time_motion`.

    Returns:
        [..., n] N, positive when it resists compression.
    """
    return model.force(motion)
