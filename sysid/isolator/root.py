"""The zero of a falling function of one number, safely and in few steps."""

from collections.abc import Callable
from typing import Final, NamedTuple, TypeAlias

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int

from sysid.isolator.plant import Number

Curve: TypeAlias = Callable[[Number], tuple[Number, Number]]
"""z → value, slope."""
_SETTLED: Final = 1e-9
"""Last step, in parts of the value and its scale: the one after it is its square."""
_MOST: Final = 40
"""Steps, where rounding keeps a very steep function from settling."""
STEEPEST: Final = -0.25
"""Largest slope that the function is believed to have."""


class _Search(NamedTuple):
    """Where it is: z, the points beside it, and how long the last step was."""

    steps: Int[Array, "..."]
    found: Number
    low: Number
    high: Number
    step: Number


def with_slope(function: Callable[[Number], Number]) -> Curve:
    """A function and its slope, by forward differentiation."""
    return lambda z: jax.jvp(function, (z,), (jnp.ones_like(z),))


def falling_root(lacking: Curve, start: Number, scale: float) -> Number:
    """Newton's method, kept between the points where the function was seen above and below zero.

    A force that bends within a step, as at a reversal, costs a step more; one that is nearly
    straight is found in two or three.  Runs that are mapped go on until the last has settled.

    Args:
        lacking: Value and slope, which falls by `STEEPEST` or more.
        start: Where it begins.
        scale: Below this z need not be known to more than a part in 10⁹ of it.
    """
    far = jnp.full_like(start, jnp.inf)

    def unsettled(search: _Search) -> Bool[Array, "..."]:
        close = _SETTLED * (jnp.abs(search.found) + scale)
        return (search.steps < _MOST) & (search.step > close)

    def better(search: _Search) -> _Search:
        steps, found, low, high, _ = search
        value, slope = lacking(found)
        low, high = jnp.where(value > 0.0, found, low), jnp.where(value < 0.0, found, high)
        newton = found - value / jnp.minimum(slope, STEEPEST)
        inside = (newton >= low) & (newton <= high)
        middle = 0.5 * (low + high)
        # where the function was seen on one side only there is no middle, and only rounding is out
        there = jnp.where(inside | ~jnp.isfinite(middle), newton, middle)
        return _Search(steps + 1, there, low, high, jnp.abs(there - found))

    begin = _Search(jnp.zeros((), dtype=int), start, -far, far, far)
    return jax.lax.while_loop(unsettled, better, begin).found
