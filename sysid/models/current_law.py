"""How the parameters of the rival models depend on current."""

import jax.numpy as jnp
from jaxtyping import Array, Float

_STRAIGHT = 1e-6


def effective_current(
    current: Float[Array, "..."], bend: Float[Array, "..."]
) -> Float[Array, "..."]:
    r"""s(i) = (1 − e^{−q |i|}) / q: the current as far as the field makes use of it.

    Every law of a rival model is P(i) = P_a + P_b s(i).  With q = 0 it is the linear law of
    Spencer et al.; q > 0 bends it down, as steel and fluid saturate, and q < 0 bends it up, as the
    yield stress grows faster than the field where the field is weak.  It is the same circuit, so
    the one q serves all laws of a model.

    Args:
        current: A, [...].
        bend: q, 1/A, of any sign.

    Returns:
        A, [...], even in the current.
    """
    i = jnp.abs(current)
    straight = jnp.abs(bend * i) < _STRAIGHT
    q = jnp.where(jnp.abs(bend) < 1e-12, 1.0, bend)
    # the second order is kept so that the derivative by q is right at q = 0 as well
    return jnp.where(straight, i * (1.0 - 0.5 * bend * i), -jnp.expm1(-q * i) / q)
