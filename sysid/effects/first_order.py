"""First-order linear recurrences along a signal, periodic or from rest."""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Inexact

Signal = Inexact[Array, "*batch n"]


def first_order(
    kept: Signal, drive: Signal, *, periodic: bool, start: Inexact[Array, "*batch"] | float = 0.0
) -> Signal:
    """Solve y_n = α_n y_{n−1} + b_n.

    Its changes obey dy_n = α_n dy_{n−1} + (dα_n y_{n−1} + db_n), the same recurrence: products of α
    are there, and derivatives cost one more pass instead of two.

    Args:
        kept: α, [..., n].
        drive: b, [..., n].
        periodic: y_{−1} is y_{n−1}; all α must not be 1 then (y = Σb otherwise).
        start: y_{−1} where not periodic, [...].
    """
    return _solved(periodic, kept, drive, jnp.asarray(start))


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def _solved(periodic: bool, kept: Array, drive: Array, start: Array) -> Array:
    return _parts(kept, drive, start, periodic=periodic)[0]


@_solved.defjvp
def _solved_jvp(
    periodic: bool, at: tuple[Array, Array, Array], along: tuple[Array, Array, Array]
) -> tuple[Array, Array]:
    kept, (kept_change, drive_change, start_change) = at[0], along
    y, product, begin = _parts(*at, periodic=periodic)
    first = jnp.broadcast_to(begin, y[..., :1].shape).astype(y.dtype)
    before = jnp.concatenate([first, y[..., :-1]], axis=-1)
    change = _from_zero(kept, kept_change * before + drive_change)
    begins = _closing(product, change) if periodic else start_change[..., None]
    return y, change + product * begins


def _parts(
    kept: Array, drive: Array, start: Array, *, periodic: bool
) -> tuple[Array, Array, Array]:
    """[..., n] y; [..., n] products of α up to each place; [..., 1] y_{−1}."""

    def step(past: tuple[Array, Array], now: tuple[Array, Array]) -> tuple[tuple, tuple]:
        new = (now[0] * past[0], now[0] * past[1] + now[1])
        return new, new

    begin = (jnp.ones_like(kept[..., 0]), jnp.zeros_like(drive[..., 0]))
    _, found = jax.lax.scan(step, begin, (_places_first(kept), _places_first(drive)))
    product, answer = (jnp.moveaxis(z, 0, -1) for z in found)
    begins = _closing(product, answer) if periodic else start[..., None]
    return answer + product * begins, product, begins


def _from_zero(kept: Array, drive: Array) -> Array:
    """[..., n] y from y_{−1} = 0."""

    def step(past: Array, now: tuple[Array, Array]) -> tuple[Array, Array]:
        new = now[0] * past + now[1]
        return new, new

    zero = jnp.zeros_like(drive[..., 0])
    _, found = jax.lax.scan(step, zero, (_places_first(kept), _places_first(drive)))
    return jnp.moveaxis(found, 0, -1)


def _closing(product: Array, answer: Array) -> Array:
    """[..., 1] y_{−1} = y_{n−1} of what is `answer` from zero; zero where all α are 1."""
    rest = 1.0 - product[..., -1:]
    some = rest > 0.0
    return jnp.where(some, answer[..., -1:] / jnp.where(some, rest, 1.0), 0.0)


def _places_first(z: Array) -> Array:
    return jnp.moveaxis(z, -1, 0)
