"""States that follow the displacement: hysteresis that does not know how fast it is run through.

Between two points of a grid such a state has moved as its exact flow in displacement says, however
far they are apart, so coarse and fine grids agree wherever the motion between points keeps its
direction.  A steady loop starts from the state that the turning points alone lead to.
"""

from collections.abc import Callable
from typing import Final, TypeAlias

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

State: TypeAlias = Float[Array, "*batch"]
Flow: TypeAlias = Callable[[State, State], State]
"""(state, displacement run through in one direction, m) → state."""

HALVES: Final = 24
"""Halves of a cycle by which the state at the turning points of a steady loop is found."""


def follow(
    flow: Flow, displacement: Float[Array, "*batch n"], *, periodic: bool
) -> Float[Array, "*batch n"]:
    """The state at every point of a motion.

    Args:
        flow: Exact solution over a stretch of one direction.
        displacement: [..., n] m.
        periodic: The grid is one whole cycle of a steady motion; otherwise the state is zero at
            the first point.

    Returns:
        [..., n].
    """
    first = displacement[..., 0]
    start = turning_start(flow, displacement) if periodic else jnp.zeros(first.shape)

    def step(state: State, run: State) -> tuple[State, State]:
        state = flow(state, run)
        return state, state

    runs = jnp.moveaxis(jnp.diff(displacement, axis=-1), -1, 0)
    _, states = jax.lax.scan(step, start, runs)
    return jnp.moveaxis(jnp.concatenate([start[None], states]), 0, -1)


def turning_start(flow: Flow, displacement: Float[Array, "*batch n"]) -> State:
    """The state at the first point of a steady loop, from its two turning points.

    The flows here are odd: a steady state is w at one turning point and −w at the other, where
    h(w) = −flow(w, −stroke) = w.  h falls, by less than 1 for 1, so w − h(w) rises by 1 to 2, and
    steps of (h(w) − w)/1.5 leave a third of the error each, of strokes of any length.

    Args:
        flow: Exact solution over a stretch of one direction, odd.
        displacement: [..., n] m, one whole cycle.
    """
    high, low = displacement.max(axis=-1), displacement.min(axis=-1)
    stroke = high - low

    def half(state: State, _: None) -> tuple[State, None]:
        return state - (state + flow(state, -stroke)) / 1.5, None

    state, _ = jax.lax.scan(half, jnp.zeros(stroke.shape), length=HALVES)
    state = -flow(state, -stroke)
    falling = displacement.argmax(axis=-1) > displacement.argmin(axis=-1)
    last, state = jnp.where(falling, high, low), jnp.where(falling, state, -state)
    return flow(state, displacement[..., 0] - last)


def dahl_flow(rho: Float[Array, "..."]) -> Flow:
    r"""Exact flow of dw/dx = ρ (1 − w sgn dx).

    Args:
        rho: ρ, 1/m, one or one a state.
    """

    def flow(state: State, run: State) -> State:
        ahead = jnp.where(run >= 0.0, 1.0, -1.0)
        return state - (ahead - state) * jnp.expm1(-rho * jnp.abs(run))

    return flow


def bouc_wen_flow(rho: Float[Array, "..."], sigma: Float[Array, ""]) -> Flow:
    r"""Exact flow of dw/dx = ρ (1 − σ sgn(dx) |w| w − (1 − σ) w²), σ ≥ 1/2.

    With y = w sgn dx it is dy/dh = 1 − y² where y > 0 and 1 + κ² y² where y < 0, κ² = 2σ − 1 and
    h = ρ |dx|: a hyperbolic tangent and a tangent, joined at y = 0.

    Args:
        rho: ρ, 1/m, one or one a state.
        sigma: σ, pure number.
    """
    kappa = jnp.sqrt(jnp.maximum(2.0 * sigma - 1.0, 1e-12))

    def flow(state: State, run: State) -> State:
        ahead = jnp.where(run >= 0.0, 1.0, -1.0)
        y = ahead * state
        angle = jnp.arctan(kappa * jnp.minimum(y, 0.0)) + kappa * rho * jnp.abs(run)
        unloading = jnp.tan(jnp.minimum(angle, 0.0)) / kappa
        rise, y = jnp.tanh(jnp.maximum(angle, 0.0) / kappa), jnp.maximum(y, 0.0)
        loading = (y + rise) / (1.0 + y * rise)
        return ahead * jnp.where(angle < 0.0, unloading, loading)

    return flow
