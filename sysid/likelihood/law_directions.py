"""Directions in which laws of a valve, or the thermometer, may be wrong, for Σ."""

from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array

from sysid.effects.base import AbstractLawEffect, Changes, ValveParts
from sysid.effects.base import Parts as ForceParts
from sysid.models.base import AbstractInnerValve
from sysid.models.damper import Damper
from sysid.motion.motion import Motion

WIDER: Final = 0.1
"""A hundred per cent of loop width, in parts of the peak velocity: the order of measured loops."""


@eqx.filter_jit
def law_directions(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[2, L, m] N: the loop made wider by its own width, and its force stretched over velocity.

    A valve whose width is that of a spring is given another spring and another viscosity: it goes
    by displacement and velocity, and neither can be stretched without the other.
    """
    if isinstance(damper.valve, AbstractInnerValve):
        return _laws_inside(damper, motion, columns)

    def through(velocity: Array) -> Array:
        return damper.force(eqx.tree_at(lambda m: m.velocity, motion, velocity)) @ columns

    v = motion.velocity
    shift = WIDER * motion.peak_velocity * motion.acceleration_sign
    wider = jax.jvp(through, (v,), (shift,))[1]
    steeper = jax.jvp(through, (v,), (v,))[1]
    return jnp.stack([wider, steeper])


class _OtherLaws(AbstractLawEffect):
    """A valve that is softer and more viscous than it is taken to be, each in parts of itself."""

    softer: Array
    thicker: Array

    def parts(self, motion: Motion, valve: ValveParts) -> ForceParts:
        """The parts of that valve."""
        changes = Changes(stiffness=1.0 / (1.0 + self.softer), viscous=1.0 + self.thicker)
        return valve.changed(motion, changes)


def _laws_inside(damper: Damper, motion: Motion, columns: Array) -> Array:
    """The same for a valve with a spring, whose loop is as wide as that is soft."""

    def through(softer: Array, thicker: Array) -> Array:
        changed = (_OtherLaws(softer, thicker), *damper.effects)
        return Damper(damper.valve, changed).force(motion) @ columns

    one, none = jnp.ones(()), jnp.zeros(())
    _, push = jax.linearize(through, none, none)
    return jnp.stack([push(one, none), push(none, one)])


@eqx.filter_jit
def change_with_warmth(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[L, m] N/K: all of a test were warmer than its thermometer says."""

    def at(temperature: Array) -> Array:
        return damper.force(eqx.tree_at(lambda m: m.temperature, motion, temperature)) @ columns

    t = motion.temperature
    return jax.jvp(at, (t,), (jnp.ones_like(t),))[1]
