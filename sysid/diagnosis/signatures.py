"""What each effect alone would add to a base model's loops, without simulating more than needed."""

from collections.abc import Sequence
from typing import Final, TypeVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.diagnosis.evidence import Evidence
from sysid.effects.base import AbstractChannelEffect, AbstractEffect, AbstractForceEffect
from sysid.likelihood.observed import by_batches
from sysid.models.base import AbstractValve
from sysid.models.damper import Damper
from sysid.motion.motion import Motion

E = TypeVar("E", bound=AbstractEffect)

ROUNDING: Final = 1e-10
"""A change of the force by less than this part of it, at a nominal size, is rounding."""


def signatures(
    evidence: Evidence,
    valve: AbstractValve,
    effects: Sequence[AbstractEffect],
    weight: Float[Array, "simulated phase"] | None = None,
) -> Float[np.ndarray, "loop m effect"]:
    """[F with an effect − F without it]/its size, N per unit of the size.

    A force beside the valve is the same whatever the valve does, and a channel acts on the force
    that the valve has; only drive, motion and law need the valve simulated anew.

    Args:
        evidence: The campaign.
        valve: The base model.
        effects: One at a time beside the valve, each at the size that it is linearised over.
        weight: [L, points] of the evidence's motion, by which the change is multiplied; 1 if None.

    Returns:
        [L, m, K] N/unit, for K effects.
    """
    motion, columns = evidence.motion, evidence.columns
    force = _alone(valve, motion)
    weight = jnp.ones((1, 1)) if weight is None else weight
    found = []
    for effect in effects:
        if isinstance(effect, AbstractForceEffect):
            one = _beside(effect, motion, columns, weight)
        elif isinstance(effect, AbstractChannelEffect):
            one = _recorded(effect, force, motion, columns, weight)
        else:
            one = _simulated(Damper(valve, (effect,)), force, motion, columns, weight)
        found.append(np.asarray(one)[: evidence.tests])
    return np.stack(found, axis=2)


@eqx.filter_jit
def _alone(valve: AbstractValve, motion: Motion) -> Array:
    return valve.force(motion)


@eqx.filter_jit
def _beside(effect: AbstractForceEffect, motion: Motion, columns: Array, weight: Array) -> Array:
    change = effect.force(motion) - _absent(effect).force(motion)
    return (weight * change) @ columns / _size(effect)


@eqx.filter_jit
def _recorded(
    effect: AbstractChannelEffect, force: Array, motion: Motion, columns: Array, weight: Array
) -> Array:
    change = effect.recorded(force, motion) - _absent(effect).recorded(force, motion)
    return (weight * change) @ columns / _size(effect)


@eqx.filter_jit
def _simulated(
    damper: Damper, force: Array, motion: Motion, columns: Array, weight: Array
) -> Array:
    change = by_batches(damper.force, motion) - force
    there = jnp.abs(change).max() > ROUNDING * jnp.abs(force).max()
    return jnp.where(there, weight * change, 0.0) @ columns / _size(damper.effects[0])


def _size(effect: AbstractEffect) -> Array:
    return jnp.asarray(getattr(effect, effect.facts.size))


def _absent(effect: E) -> E:
    """The effect with a size of zero: nothing."""
    symbol = effect.facts.size
    return eqx.tree_at(lambda e: getattr(e, symbol), effect, jnp.zeros_like(_size(effect)))
