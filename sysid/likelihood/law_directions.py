"""Directions in which laws of a valve, or the thermometer, may be wrong, for Σ."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import AbstractForceEffect
from sysid.models.base import AbstractValve
from sysid.models.damper import Damper
from sysid.motion.motion import Motion


@eqx.filter_jit
def force_by_laws(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[L, m] N: what an error of the scale of the valve's force scales.

    Inertia, springs, friction beside the valve are no law of the valve: an error of a tenth of its
    scale leaves them as they are.
    """
    return _valve_alone(damper).force(motion) @ columns


def _valve_alone(damper: Damper) -> Damper:
    """Without the effects that act beside the valve."""
    own = tuple(e for e in damper.effects if not isinstance(e, AbstractForceEffect))
    return Damper(damper.valve, own)


@eqx.filter_jit
def law_directions(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[3, L, m] N: change of the force for a relative change of each law of `Laws.bent` by one.

    They are the valve's own laws, not shapes that look like theirs: a cycle's mean is known to a
    thousandth of the force, and what a substitute leaves of a wrong law counts as evidence.
    A law that the valve does not have gives zeros.
    """

    def through(factors: Array) -> Array:
        return Damper(stretched(damper.valve, factors), damper.effects).force(motion) @ columns

    ones = jnp.ones(len(damper.valve.laws.bent))
    _, push = jax.linearize(through, ones)
    return jnp.stack([push(one) for one in jnp.eye(ones.size)])


def stretched(valve: AbstractValve, factors: Float[Array, " law"]) -> AbstractValve:
    """The valve with each of its laws times a factor, in the order of `Laws.bent`."""
    for factor, names in zip(factors, valve.laws.bent, strict=True):
        valve = _times(valve, names, factor)
    return valve


def _times(valve: AbstractValve, names: tuple[str, ...], factor: Array) -> AbstractValve:
    for name in names:
        valve = eqx.tree_at(lambda v, n=name: getattr(v, n), valve, replace_fn=factor.__mul__)
    return valve


@eqx.filter_jit
def yield_direction(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[L, m] N: change of the force for a relative change of the law of the yield force by one.

    Zeros, where the valve has no such law of its own.
    """

    def through(factor: Array) -> Array:
        valve = _times(damper.valve, damper.valve.laws.yielding, factor)
        return Damper(valve, damper.effects).force(motion) @ columns

    one = jnp.asarray(1.0)
    return jax.jvp(through, (one,), (one,))[1]


@eqx.filter_jit
def change_with_warmth(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[L, m] N/K: the oil of a test were warmer than its thermometer says.

    A gas beside the valve has a temperature of its own: a thermometer on the body that is wrong by
    ten kelvin about the oil in the gap is not for that wrong about the gas.
    """
    valve = _valve_alone(damper)

    def at(temperature: Array) -> Array:
        return valve.force(eqx.tree_at(lambda m: m.temperature, motion, temperature)) @ columns

    t = motion.temperature
    return jax.jvp(at, (t,), (jnp.ones_like(t),))[1]
