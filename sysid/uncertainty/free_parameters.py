"""From solver coordinates to the paper's symbols, with slopes."""

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.models.coordinates import AbstractCoordinates
from sysid.parameters import specs, values


@eqx.filter_jit
def free_parameters(
    coordinates: AbstractCoordinates[Any], u: Float[Array, " n"]
) -> tuple[Float[Array, " k"], Float[Array, "k n"]]:
    """Free parameters in their units, and their slopes ∂θ/∂u.

    Args:
        coordinates: The map.
        u: [n] where.
    """

    def at(z: Array) -> Array:
        valve = coordinates.valve(z)
        free = [k for k, s in enumerate(specs(valve)) if s.symbol in coordinates.free]
        return values(valve)[jnp.array(free)]

    return at(u), jax.jacfwd(at)(u)
