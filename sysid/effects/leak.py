"""A leak in parallel with a valve: the flow that passes it does not move the valve.

    w = v − k F(w)

F rises with w, so the root is single; Newton's method with bisection finds it.  Derivatives are
those of one Newton step at the root.  The valve stands in the program twice, in the search and at
its end.  Whoever searches for a speed anyhow takes w for the unknown, of which v is a function.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import Changes, Force, Parts, ValveParts
from sysid.motion.motion import Motion

MOST_STEPS: Final = 60
TOLERANCE: Final = 1e-10
"""Of the last change, parts of the largest speed; the Newton step at the end squares it."""


class Search(NamedTuple):
    """Where Newton's method stands.

    Attributes:
        velocity: That is left for the valve, m/s.
        low: Bound of it.
        high: Bound of it.
        change: The last one.
        slope: Of the valve's parts over velocity, where they were last evaluated, N·s/m.
        taken: Steps, a scalar.
    """

    velocity: Force
    low: Force
    high: Force
    change: Force
    slope: Parts
    taken: jax.Array


def parts_beside_leak(
    motion: Motion, valve: Callable[[Motion], Parts], leakage: Float[Array, "..."]
) -> Parts:
    """The valve's parts at the speed that is left for it.

    Args:
        motion: At the valve and its leak.
        valve: The parts, for any motion; one with states takes the leak into its equations.
        leakage: k, m/(s·N), of any shape that fits the motion; 0 changes nothing.
    """
    if isinstance(valve, ValveParts) and valve.inside is not None:
        return valve.inside(motion, Changes(leakage=leakage))

    def through(velocity: Force) -> Parts:
        return valve(eqx.tree_at(lambda m: m.velocity, motion, velocity))

    hoisted, held = jax.closure_convert(through, motion.velocity)
    still = jax.lax.stop_gradient(held)
    v, k = jax.lax.stop_gradient((motion.velocity, leakage))
    root, slope = jax.lax.stop_gradient(_root(lambda w: hoisted(w, *still), v, k))
    parts = hoisted(root, *held)
    excess = root + leakage * parts.total - motion.velocity
    step = excess / (1.0 + k * jnp.maximum(slope.total, 0.0))
    moved = jax.lax.stop_gradient(step) - step
    return Parts(parts.yielding + slope.yielding * moved, parts.viscous + slope.viscous * moved)


def _root(parts: Callable[[Force], Parts], v: Force, k: Float[Array, "..."]) -> tuple[Force, Parts]:
    """Root w of w + k F(w) = v, and the parts' slope there.

    Newton's method inside a shrinking bracket: with e the excess at w, the root lies between w
    and w − e, for k F(w) rises.  A step that is not at most half of the last one is replaced by
    bisection.
    """
    smallest = TOLERANCE * jnp.max(jnp.abs(v))

    def unfinished(state: Search) -> jax.Array:
        return jnp.any(jnp.abs(state.change) > smallest) & (state.taken < MOST_STEPS)

    def advance(state: Search) -> Search:
        w = state.velocity
        value, slope = jax.jvp(parts, (w,), (jnp.ones_like(w),))
        excess = w + k * value.total - v
        low = jnp.where(excess < 0.0, w, jnp.maximum(state.low, w - excess))
        high = jnp.where(excess > 0.0, w, jnp.minimum(state.high, w - excess))
        step = -excess / (1.0 + k * jnp.maximum(slope.total, 0.0))
        trial = w + step
        # across a kink Newton's method goes to and fro for ever
        good = (trial >= low) & (trial <= high) & (jnp.abs(step) <= 0.5 * jnp.abs(state.change))
        trial = jnp.where(good, trial, 0.5 * (low + high))
        return Search(trial, low, high, trial - w, slope, state.taken + 1)

    none, all_ = jnp.zeros_like(v), jnp.full_like(v, jnp.inf)
    start = Search(v, -all_, all_, all_, Parts(none, none), jnp.asarray(0))
    found = jax.lax.while_loop(unfinished, advance, start)
    return found.velocity, found.slope
