"""Work that a damper turns into heat, and what a warmer oil does to its force."""

from typing import Final

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import Force
from sysid.effects.reference_temperature import REFERENCE, excess_temperature
from sysid.motion.motion import Motion

THINNER: Final = 5.0e-3
"""1/K, loss of viscosity per kelvin, a convention (C_post of BS09's Table 1 loses 0.5 % of its
value at 0 °C, 0.6 to 0.7 % of that at 40 °C, where laws of temperature are relative to).  Forces
show only the product of a rise of temperature and this number, so it is fixed: what is identified
is a heating that counts in kelvins of such an oil."""


def mean_power(motion: Motion, force: Force) -> Float[Array, "*batch 1"]:
    """Mean of F v, W, over the cycle, or over the whole record where the motion has no cycle."""
    power = force * motion.velocity
    if motion.periodic or motion.time.shape[-1] < 2:
        return jnp.mean(power, axis=-1, keepdims=True)
    steps = jnp.diff(motion.time, axis=-1)
    work = jnp.sum(0.5 * (power[..., 1:] + power[..., :-1]) * steps, axis=-1, keepdims=True)
    return work / jnp.sum(steps, axis=-1, keepdims=True)


def thinning(rise: Float[Array, "*batch h"]) -> Float[Array, "*batch h"]:
    """Factor on the viscosity of oil that is warmer by `rise`, K: it falls by `THINNER` each."""
    return jnp.exp(-THINNER * rise)


def warmer(motion: Motion, rise: Float[Array, "*batch h"]) -> Motion:
    """The same motion in oil that is warmer by `rise`, K, than its temperature says."""
    oil = REFERENCE + excess_temperature(motion) + rise
    return eqx.tree_at(lambda m: m.temperature, motion, oil)
