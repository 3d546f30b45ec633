"""How far the field has risen at a current: an S-shaped law that ends in saturation."""

import jax.numpy as jnp
from jaxtyping import Array, Float

_NO_CURRENT = 1e-12
"""Parts of i_s below which no current flows; keeps the derivative of a power finite."""


def field_share(
    current: Float[Array, "..."], scale: Float[Array, "..."], order: Float[Array, "..."]
) -> Float[Array, "..."]:
    r"""g(i) = 1 − e^{−(|i|/i_s)^m}: part of the force at saturation that a current makes.

    m > 1 begins flat and rises steeper afterwards, as the yield stress grows with the square of a
    weak field; m ≤ 1 is bent down from the start, as where seals and remanence hide the weak
    field.  For i ≪ i_s it is the power law of order m.

    Args:
        current: i, A, [...].
        scale: i_s, A.
        order: m, a pure number.

    Returns:
        0 … 1, [...], even in the current.

    Source:
        Shape: W. Weibull, J. Appl. Mech. 18 (1951).  Order 2 of the yield stress in weak fields,
        3/2 and saturation in stronger ones: J. M. Ginder, L. C. Davis, L. D. Elie, Int. J. Mod.
        Phys. B 10 (1996).
    """
    share = jnp.maximum(jnp.abs(current) / scale, _NO_CURRENT)
    return -jnp.expm1(-(share**order))
