"""Forces of a model on a motion at many draws of its parameters, in one compiled call."""

from typing import Any, Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.models.coordinates import AbstractCoordinates
from sysid.motion.motion import Motion

BLOCK: Final = 16
"""Tests whose draws are held in memory at once; a motion is filled up to as many, so that one
program is compiled."""
TOGETHER: Final = 8
"""Draws that are computed at once."""


def blocks_of(motion: Motion) -> list[slice]:
    """Tests of a motion, some at a time."""
    count = motion.displacement.shape[0]
    return [slice(k, min(k + BLOCK, count)) for k in range(0, count, BLOCK)]


def force_draws(
    coordinates: AbstractCoordinates[Any], u: Float[np.ndarray, "draw n"], motion: Motion
) -> Float[np.ndarray, "draw loop point"]:
    """Force at every point of a motion, at every draw.

    Args:
        coordinates: Map from u to the model.
        u: [D, n] draws.
        motion: [L, P].

    Returns:
        [D, L, P] N.
    """
    count = motion.displacement.shape[0]
    filled = np.minimum(np.arange(-(-count // BLOCK) * BLOCK), count - 1)
    wide = jax.tree.map(lambda z: z[filled], motion) if count > 1 else motion
    draws = np.concatenate([u, np.repeat(u[-1:], -len(u) % TOGETHER, axis=0)])
    return np.asarray(_forces(coordinates, jnp.asarray(draws), wide))[: len(u), :count]


def batch_of(motion: Motion) -> Motion:
    """A single record [n] as one test [1, n]; several tests as they are."""
    if motion.displacement.ndim > 1:
        return motion
    return jax.tree.map(lambda z: jnp.asarray(z)[None], motion)


def some_of(motion: Motion, some: slice) -> Motion:
    """Some tests of a motion."""
    return jax.tree.map(lambda z: z[some], motion)


@eqx.filter_jit
def _forces(coordinates: AbstractCoordinates[Any], u: Array, motion: Motion) -> Array:
    def one(z: Array) -> Array:
        return coordinates.valve(z).force(motion)

    return jax.lax.map(one, u, batch_size=TOGETHER)
