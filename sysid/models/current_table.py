"""A law given at some currents, as a table, with straight lines between them."""

from collections.abc import Sequence

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar


def read_table(
    current: Float[Array, "*batch c"], currents: Sequence[float], values: Sequence[Scalar]
) -> Float[Array, "*batch c"]:
    """The value at a current.

    Straight lines keep what the table says and add nothing to it: between two currents the law
    lies between their values, so it rises and falls where the table does and nowhere else.  Beyond
    the last current the last line goes on.

    Args:
        current: A, [..., c]; only its magnitude counts.
        currents: [I] A, increasing from 0.
        values: [I], one at each of them.
    """
    knots, heights = jnp.asarray(currents), jnp.stack(list(values))
    i = jnp.abs(current)
    below = jnp.clip(jnp.searchsorted(knots, i, side="right") - 1, 0, len(currents) - 2)
    share = (i - knots[below]) / (knots[below + 1] - knots[below])
    return heights[below] + share * (heights[below + 1] - heights[below])
