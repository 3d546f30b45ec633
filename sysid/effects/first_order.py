"""First-order linear recurrences along a signal, periodic or from rest."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Inexact

Signal = Inexact[Array, "*batch n"]


def first_order(
    kept: Signal, drive: Signal, *, periodic: bool, start: Inexact[Array, "*batch"] | float = 0.0
) -> Signal:
    """Solve y_n = α_n y_{n−1} + b_n.

    Args:
        kept: α, [..., n].
        drive: b, [..., n].
        periodic: y_{−1} is y_{n−1}; all α must not be 1 then (y = Σb otherwise).
        start: y_{−1} where not periodic, [...].
    """

    def step(
        past: tuple[jax.Array, jax.Array], now: tuple[jax.Array, jax.Array]
    ) -> tuple[tuple[jax.Array, jax.Array], tuple[jax.Array, jax.Array]]:
        new = (now[0] * past[0], now[0] * past[1] + now[1])
        return new, new

    inputs = (jnp.moveaxis(kept, -1, 0), jnp.moveaxis(drive, -1, 0))
    begin = (jnp.ones_like(kept[..., 0]), jnp.zeros_like(drive[..., 0]))
    _, found = jax.lax.scan(step, begin, inputs)
    product, answer = (jnp.moveaxis(z, 0, -1) for z in found)
    if not periodic:
        return answer + product * jnp.asarray(start)[..., None]
    rest = 1.0 - product[..., -1:]
    closed = jnp.where(rest > 0.0, answer[..., -1:] / jnp.where(rest > 0.0, rest, 1.0), 0.0)
    return answer + product * closed
