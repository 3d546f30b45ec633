"""What each effect alone would add to a base model's loops, without simulating more than needed."""

from collections.abc import Sequence
from functools import partial
from typing import Final, TypeVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.diagnosis.evidence import Evidence
from sysid.effects.base import AbstractChannelEffect, AbstractEffect, AbstractForceEffect
from sysid.likelihood.batches import by_batches, in_batches
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
    weight: Float[np.ndarray, "simulated phase"] | None = None,
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
    motion, columns = evidence.batches, evidence.columns
    force = by_batches(partial(_alone, valve), motion)
    weights = in_batches(np.ones((len(force), 1)) if weight is None else weight)
    forces, found = in_batches(force), []
    for effect in effects:
        if isinstance(effect, AbstractForceEffect):
            one = by_batches(partial(_beside, effect, columns), motion, weights)
        elif isinstance(effect, AbstractChannelEffect):
            one = by_batches(partial(_recorded, effect, columns), motion, weights, forces)
        else:
            damper = Damper(valve, (effect,))
            one, largest = by_batches(partial(_simulated, damper, columns), motion, weights, forces)
            if not largest.max() > ROUNDING * np.abs(force).max():
                one = np.zeros_like(one)
        found.append(one[: evidence.tests])
    return np.stack(found, axis=2)


@eqx.filter_jit
def _alone(valve: AbstractValve, motion: Motion) -> Array:
    return valve.force(motion)


@eqx.filter_jit
def _beside(effect: AbstractForceEffect, columns: Array, motion: Motion, weight: Array) -> Array:
    change = effect.force(motion) - _absent(effect).force(motion)
    return (weight * change) @ columns / _size(effect)


@eqx.filter_jit
def _recorded(
    effect: AbstractChannelEffect, columns: Array, motion: Motion, weight: Array, force: Array
) -> Array:
    change = effect.recorded(force, motion) - _absent(effect).recorded(force, motion)
    return (weight * change) @ columns / _size(effect)


@eqx.filter_jit
def _simulated(
    damper: Damper, columns: Array, motion: Motion, weight: Array, force: Array
) -> tuple[Array, Array]:
    change = damper.force(motion) - force
    return weight * change @ columns / _size(damper.effects[0]), jnp.abs(change).max(axis=1)


def _size(effect: AbstractEffect) -> Array:
    return jnp.asarray(getattr(effect, effect.facts.size))


def _absent(effect: E) -> E:
    """The effect with a size of zero: nothing."""
    symbol = effect.facts.size
    return eqx.tree_at(lambda e: getattr(e, symbol), effect, jnp.zeros_like(_size(effect)))
