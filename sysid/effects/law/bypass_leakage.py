"""Leakage past the valve under its own pressure."""

from collections.abc import Callable
from typing import ClassVar, Final

import equinox as eqx
import jax
import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Facts, Force, Parts
from sysid.motion.motion import Motion
from sysid.parameters import param

MOST_STEPS: Final = 60
TOLERANCE: Final = 1e-13


class BypassLeakage(AbstractLawEffect):
    r"""Part of the flow leaks past the piston in proportion to the force, at every instant.

        v_eff = v − k_l F(v_eff)

    F rises with v, so the root is single and lies between v and v − k_l F(v); Newton's method
    with bisection finds it.  Derivatives are those of one Newton step at the root.

    Source:
        Laminar leakage past a piston ring, 10⁻⁷–3·10⁻⁶ (m/s)/N.
    """

    facts: ClassVar[Facts] = Facts(
        id="bypass_leakage",
        family="friction",
        found_from="loops",
        size="k_l",
        nominal={"k_l": 1.0e-6},
        realistic={"k_l": (1.0e-7, 3.0e-6)},
        parity=("OD", 0.67),
        exponents=(-0.17, -0.21, 0.8),
        rivals=("seal_friction", "series_compliance"),
        separating_test="hold a constant load and watch the piston creep",
        source="laminar leakage past a piston ring",
    )
    k_l: Scalar = param(
        symbol="k_l", name="leakage per force", unit="m/(s·N)", low=0.0, typical=1.0e-6
    )

    def parts(self, motion: Motion, valve: Callable[[Motion], Parts]) -> Parts:
        """The parts at the speed that does not leak."""

        def through(velocity: Force) -> Motion:
            return eqx.tree_at(lambda m: m.velocity, motion, velocity)

        def total(velocity: Force) -> Force:
            return valve(through(velocity)).total

        hoisted, held = jax.closure_convert(total, motion.velocity)
        still = jax.lax.stop_gradient(held)
        v, k = jax.lax.stop_gradient((motion.velocity, self.k_l))
        root = _root(lambda w: hoisted(w, *still), v, k)
        slope = 1.0 + k * jnp.maximum(_with_slope(lambda w: hoisted(w, *still), root)[1], 0.0)
        excess = root + self.k_l * hoisted(root, *held) - motion.velocity
        step = excess / slope
        exact = jnp.where(k == 0.0, v, root)
        return valve(through(exact - (step - jax.lax.stop_gradient(step))))


def _with_slope(force: Callable[[Force], Force], velocity: Force) -> tuple[Force, Force]:
    return jax.jvp(force, (velocity,), (jnp.ones_like(velocity),))


def _root(force: Callable[[Force], Force], v: Force, k: Scalar) -> Force:
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
