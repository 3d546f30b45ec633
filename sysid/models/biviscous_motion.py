"""The bi-viscous element on the grid of a motion."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array

from sysid.models.biviscous import Element, State, Stretch
from sysid.models.biviscous_orbit import follow_biviscous
from sysid.motion.motion import Motion

_follow = jax.jit(follow_biviscous, static_argnums=0)
"""Compiled once for all that stands around it, where that is not compiled as a whole."""


def biviscous_states(element: Element, motion: Motion) -> State:
    """Compression of the spring and velocity of the element at every point, [..., n] each.

    Args:
        element: Its numbers, [..., n] or [..., 1], or scalars.
        motion: One steady cycle, or any motion, which then starts from rest.
    """
    ends = _follow(motion.periodic, _stretches(element, motion))
    if motion.periodic:
        # the last step ends in the first point
        return _batch_first(ends, lambda z: jnp.roll(z, 1, axis=0))
    return _batch_first(ends, lambda z: jnp.concatenate([jnp.zeros_like(z[:1]), z]))


def _stretches(element: Element, motion: Motion) -> Stretch:
    """The steps of the grid, [n or n − 1, ...]: the cubic, and means of both ends.

    What holds through the motion is [1, ...].
    """
    v, n, periodic = motion.velocity, motion.velocity.shape[-1], motion.periodic

    def ends(z: Array) -> tuple[Array, Array]:
        z = jnp.moveaxis(jnp.broadcast_to(z, v.shape), -1, 0)
        return (z, jnp.roll(z, -1, axis=0)) if periodic else (z[:-1], z[1:])

    def mean(z: Array) -> Array:
        if jnp.ndim(z) == 0 or z.shape[-1] == 1:
            return jnp.moveaxis(jnp.broadcast_to(z, (*v.shape[:-1], 1)), -1, 0)
        z_0, z_1 = ends(z)
        return 0.5 * (z_0 + z_1)

    travel, (v_0, v_1) = ends(motion.strides)[0], ends(v)
    if periodic:
        time = ends(1.0 / (n * motion.frequency))[0]
    else:
        begin, end = ends(motion.time)
        time = end - begin
    bend = 3.0 * (v_0 + v_1) - 6.0 * travel / time
    means = jax.tree.map(mean, element)
    return Stretch(time, v_0, (v_1 - v_0 - bend) / time, bend / time**2, means)


def _batch_first(state: State, on_grid: Callable[[Array], Array]) -> State:
    """[steps, ...] as [..., n]."""
    return State(*(jnp.moveaxis(on_grid(z), 0, -1) for z in state))
