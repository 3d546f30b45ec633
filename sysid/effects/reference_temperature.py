"""Temperature above the reference, at which every thermal law is the identity."""

from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.motion.motion import Motion

REFERENCE: Final = 40.0
"""°C."""


def excess_temperature(motion: Motion) -> Float[Array, "*batch t"]:
    """T − 40 °C in K; 0 where the temperature is not known."""
    excess = motion.temperature - REFERENCE
    return jnp.where(jnp.isnan(excess), 0.0, excess)
