"""A leak in parallel with a valve: the flow that passes it does not move the valve.

    w = v − k F(w)

F rises with w, so the root is single and lies between v and v − k F(v); Newton's method with
bisection finds it.  Derivatives are those of one Newton step at the root.
"""

from collections.abc import Callable
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import Force, Parts
from sysid.motion.motion import Motion

MOST_STEPS: Final = 60
TOLERANCE: Final = 1e-13


def parts_beside_leak(
    motion: Motion, valve: Callable[[Motion], Parts], leakage: Float[Array, "..."]
) -> Parts:
    """The valve's parts at the speed that is left for it.

    Args:
        motion: At the valve and its leak.
        valve: The parts, for any motion.
        leakage: k, m/(s·N), of any shape that fits the motion; 0 changes nothing.
    """

    def through(velocity: Force) -> Motion:
        return eqx.tree_at(lambda m: m.velocity, motion, velocity)

    def total(velocity: Force) -> Force:
        return valve(through(velocity)).total

    hoisted, held = jax.closure_convert(total, motion.velocity)
    still = jax.lax.stop_gradient(held)
    v, k = jax.lax.stop_gradient((motion.velocity, leakage))
    root = _root(lambda w: hoisted(w, *still), v, k)
    slope = 1.0 + k * jnp.maximum(_with_slope(lambda w: hoisted(w, *still), root)[1], 0.0)
    excess = root + leakage * hoisted(root, *held) - motion.velocity
    step = excess / slope
    exact = jnp.where(k == 0.0, v, root)
    return valve(through(exact - (step - jax.lax.stop_gradient(step))))


def _with_slope(force: Callable[[Force], Force], velocity: Force) -> tuple[Force, Force]:
    return jax.jvp(force, (velocity,), (jnp.ones_like(velocity),))


def _root(force: Callable[[Force], Force], v: Force, k: Float[Array, "..."]) -> Force:
    """Root w of w + k F(w) = v, by Newton's method inside a shrinking bracket."""
    other = v - k * force(v)
    low, high = jnp.minimum(v, other), jnp.maximum(v, other)
    smallest = TOLERANCE * jnp.max(jnp.abs(v))

    def unfinished(state: tuple[Force, Force, Force, Force, jax.Array]) -> jax.Array:
        *_, change, count = state
        return jnp.any(jnp.abs(change) > smallest) & (count < MOST_STEPS)

    def advance(
        state: tuple[Force, Force, Force, Force, jax.Array],
    ) -> tuple[Force, Force, Force, Force, jax.Array]:
        w, low, high, _, count = state
        value, slope = _with_slope(force, w)
        excess = w + k * value - v
        low, high = jnp.where(excess < 0.0, w, low), jnp.where(excess > 0.0, w, high)
        trial = w - excess / (1.0 + k * jnp.maximum(slope, 0.0))
        inside = (trial >= low) & (trial <= high)
        trial = jnp.where(inside, trial, 0.5 * (low + high))
        return trial, low, high, trial - w, count + 1

    start = 0.5 * (low + high)
    return jax.lax.while_loop(
        unfinished, advance, (start, low, high, high - low + 1.0, jnp.asarray(0))
    )[0]
