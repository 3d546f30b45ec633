"""The bristle that a seal or a guide bends before it slides, in parts of what it can carry."""

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import Force
from sysid.effects.first_order import first_order
from sysid.motion.motion import Motion

_SMALLEST = 1e-12
"""m; a bristle that bends less turns over at once."""


def bent(motion: Motion, travel: Scalar) -> Force:
    r"""How far the bristle is bent, −1 to 1.

        dy/|dx| = (sgn v − y) / (presliding travel)

    Solved exactly on every step between two samples, and in closed form for the state that repeats
    itself after a cycle; any other motion starts relaxed.  At standstill it is bent as the motion
    before has left it.

    Args:
        motion: Of the rod.
        travel: m, over which it takes up its force.

    Source:
        P. R. Dahl (1968).
    """
    x = motion.displacement
    moved = x - jnp.roll(x, 1, axis=-1)
    if not motion.periodic:
        moved = moved.at[..., 0].set(0.0)
    part = jnp.abs(moved) / jnp.maximum(travel, _SMALLEST)
    kept, sliding = jnp.exp(-part), -jnp.expm1(-part)
    return first_order(kept, sliding * jnp.sign(moved), periodic=motion.periodic)
