"""Sign of a velocity without a jump."""

from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Float

REST_SPEED: Final = 3.0e-4
"""v_s, m/s: speed below which friction and one-way valves change over.  The slowest tests have peak
velocities of 1 to 0.3 mm/s, at which a seal slides."""


def smooth_sign(velocity: Float[Array, "*batch n"]) -> Float[Array, "*batch n"]:
    """sgn_s(v) = tanh(v / v_s), both velocities in m/s."""
    return jnp.tanh(velocity / REST_SPEED)
