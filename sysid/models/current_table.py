"""A law given at some currents, as a table, with straight lines between them."""

from collections.abc import Sequence

import jax.numpy as jnp
from jaxtyping import Array, Float


def read_table(
    current: Float[Array, "*batch c"], currents: Sequence[float], values: Float[Array, " table"]
) -> Float[Array, "*batch c"]:
    """The value at a current.

    Straight lines keep what the table says and add nothing to it: between two currents the law
    lies between their values, so it rises and falls where the table does and nowhere else.  Beyond
    the last current the last line goes on, below the first the first one; a table of one current
    does not depend on it.

    Args:
        current: A, [..., c]; only its magnitude counts.
        currents: [I] A, increasing.
        values: [I], one at each of them.
    """
    i = jnp.abs(current)
    if len(currents) == 1:
        return jnp.broadcast_to(values[0], i.shape)
    knots, heights = jnp.asarray(currents), values
    below = jnp.clip(jnp.searchsorted(knots, i, side="right") - 1, 0, len(currents) - 2)
    share = (i - knots[below]) / (knots[below + 1] - knots[below])
    return heights[below] + share * (heights[below + 1] - heights[below])
