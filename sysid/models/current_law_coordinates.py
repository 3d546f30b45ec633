"""Solver coordinates of a parameter's law in current: its value without and its rise with it."""

from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.models.coordinates import positive, unpositive
from sysid.models.current_law import effective_current

_SMALLEST: Final = 1e-6
_LIMIT: Final = 15.0
"""Beyond |qI| = 15 the law is a step or an exponential to seven digits: nothing changes."""


def bend_at(u: Scalar, current: Scalar) -> tuple[Scalar, Scalar]:
    """q, 1/A, and s(I) at the reference current I, A; u is qI, kept within ±15."""
    q = _LIMIT * jnp.tanh(u / _LIMIT) / current
    return q, effective_current(current, q)


def bend_confined(current: Scalar) -> tuple[tuple[str, str], ...]:
    """What `bend_at` keeps q within, as `AbstractCoordinates.confined` has it; current I in A."""
    return (("q", f"within ± {_LIMIT / float(current):.3g} 1/A"),)


def bend_place(q: Scalar, current: Scalar) -> tuple[Scalar, Scalar]:
    """U of q, 1/A, and s(I) at the reference current I, A: the way back of `bend_at`."""
    u = _LIMIT * jnp.arctanh(jnp.clip(q * current / _LIMIT, -0.999, 0.999))
    return u, effective_current(current, q)


def law_at(u: Float[Array, " 2"], unit: Scalar, effective: Scalar) -> tuple[Scalar, Scalar]:
    """P_a and P_b of P(i) = P_a + P_b s(i), both positive.

    Args:
        u: [log P_a/unit, inverse softplus of P_b s(I)/unit].
        unit: Reference magnitude of P.
        effective: s(I), A.
    """
    return unit * jnp.exp(u[0]), unit * positive(u[1]) / effective


def law_place(P_a: Scalar, P_b: Scalar, unit: Scalar, effective: Scalar) -> tuple[Scalar, Scalar]:
    """The way back of `law_at`; values of zero are moved just inside."""
    return jnp.log(jnp.maximum(P_a / unit, _SMALLEST)), unpositive(P_b * effective / unit)
