"""A Bouc–Wen element with dashpot and spring, in series with a second dashpot.

The travel u = x − y of the element and its state w obey

    (c_0 + c_1) u̇ = c_1 ẋ − α w − k_0 u,    dw/du as in `bouc_wen_flow`,

which is stiff wherever w changes.  Each step solves one scalar equation for the travel Δu, with w
at the end of the step by its exact flow; the weight of the end grows from the trapezium's 1/2
towards backward Euler's 1 as the step becomes stiff.
"""

from collections.abc import Callable
from typing import Final, TypeAlias

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.models.internal_state import bouc_wen_flow
from sysid.motion.motion import Motion

State: TypeAlias = Float[Array, "*batch"]
Pair: TypeAlias = tuple[State, State]
Curve: TypeAlias = Callable[[State], State]
History: TypeAlias = tuple[Float[Array, "steps *batch"], Float[Array, "steps *batch"]]
Cycle: TypeAlias = Callable[[Pair], tuple[Pair, History]]

STEPS_A_CYCLE: Final = 144
"""Fewest steps of a steady loop; coarser grids are divided."""
NEWTON: Final = 8
"""Newton's steps for Δu; the equation is monotone and its root bracketed."""


class SeriesLaw(eqx.Module):
    """The element's numbers; those marked [..., c] may change along the motion.

    Attributes:
        yielding: α, N, [..., c].
        inner: c_0, N·s/m, [..., c].
        outer: c_1, N·s/m, [..., c].
        stiffness: k_0, N/m.
        rho: ρ, 1/m.
        sigma: σ, pure number.
    """

    yielding: Float[Array, "*batch c"]
    inner: Float[Array, "*batch c"]
    outer: Float[Array, "*batch c"]
    stiffness: Float[Array, ""]
    rho: Float[Array, ""]
    sigma: Float[Array, ""]


class Stretch(eqx.Module):
    """One step of the grid for every test of the batch, [...] each.

    Attributes:
        time: s.
        travel: m, of x.
        enter: m, travel at the first velocity.
        leave: m, travel at the last.
        yielding: α at the end, N.
        inner: c_0 at the end, N·s/m.
        outer: c_1 at the end, N·s/m.
    """

    time: State
    travel: State
    enter: State
    leave: State
    yielding: State
    inner: State
    outer: State


def follow_in_series(law: SeriesLaw, motion: Motion) -> Float[Array, "*batch n"]:
    """Force c_1 ẏ through the element and the dashpot in series, N, [..., n]."""
    x = motion.displacement
    rows = [jnp.broadcast_to(z, x.shape) for z in (law.yielding, law.inner, law.outer)]
    stretches = _stretches(motion, *rows)
    parts = max(1, -(-STEPS_A_CYCLE // x.shape[-1])) if motion.periodic else 1

    def run(start: Pair) -> tuple[Pair, History]:
        def over(state: Pair, stretch: Stretch) -> tuple[Pair, Pair]:
            for k in range(parts):
                state = _step(law, stretch, state, k / parts, (k + 1) / parts)
            return state, state

        return jax.lax.scan(over, start, stretches)

    start = (x[..., 0], jnp.zeros(x.shape[:-1]))
    if motion.periodic:
        start = _steady_start(law, motion, rows[1] + rows[2], start, run)
        ends = run(start)[1]
        u, w = (jnp.moveaxis(jnp.roll(z, 1, axis=0), 0, -1) for z in ends)
    else:
        start = (jnp.zeros_like(start[0]), start[1])
        ends = run(start)[1]
        u, w = (
            jnp.moveaxis(jnp.concatenate([first[None], later]), 0, -1)
            for first, later in zip(start, ends, strict=True)
        )
    alpha, inner, outer = rows
    through = alpha * w + law.stiffness * u + inner * motion.velocity
    return outer * through / (inner + outer)


def _steady_start(
    law: SeriesLaw, motion: Motion, viscosity: Array, start: Pair, run: Cycle
) -> Pair:
    """State at the first point of a steady loop.

    The mean of u decays slowly, at the rate k_0/(c_0 + c_1).  So u is centred after a first cycle,
    as it is in a symmetric loop; where harmonics make it otherwise, what it loses in a second
    cycle tells how far it still has to go.
    """
    (u, w), (history, _) = run(start)
    u = u - 0.5 * (history.max(axis=0) + history.min(axis=0))
    kept = jnp.exp(-law.stiffness / (motion.frequency[..., 0] * viscosity[..., 0]))
    reach = jnp.abs(motion.displacement).max(axis=-1)
    end, w = run((u, w))[0]
    missing = (end - u) / jnp.maximum(1.0 - kept, 1e-6)
    return u + jnp.clip(missing, -reach, reach), w


def _stretches(motion: Motion, alpha: Array, inner: Array, outer: Array) -> Stretch:
    """The steps of the grid, [n or n − 1, ...]."""
    x, v = motion.displacement, motion.velocity
    if motion.periodic:
        n = x.shape[-1]
        time = jnp.broadcast_to(1.0 / (n * motion.frequency), x.shape)
        after = [jnp.roll(z, -1, axis=-1) for z in (v, alpha, inner, outer)]
        travel, now_v = motion.strides, v
    else:
        time = jnp.broadcast_to(jnp.diff(motion.time, axis=-1), x[..., 1:].shape)
        after = [z[..., 1:] for z in (v, alpha, inner, outer)]
        travel, now_v = motion.strides[..., :-1], v[..., :-1]
    new_v, *laws = after
    rows = (time, travel, now_v * time, new_v * time, *laws)
    return Stretch(*(jnp.moveaxis(z, -1, 0) for z in rows))


def _step(law: SeriesLaw, stretch: Stretch, state: Pair, begin: float, end: float) -> Pair:
    """From `begin` to `end`, in parts of a stretch."""
    u, w = state
    flow = bouc_wen_flow(law.rho, law.sigma)
    time = (end - begin) * stretch.time
    travel = _travelled(stretch, end) - _travelled(stretch, begin)
    faster = (end - begin) * (_speed(stretch, end) - _speed(stretch, begin))
    alpha, viscosity = stretch.yielding, stretch.inner + stretch.outer
    push = stretch.outer * travel - time * (law.stiffness * u + alpha * w)
    # the mean of both directions: a turn inside a step must not make the force jump
    stiff = time * alpha * law.rho * (1.0 + (law.sigma - 1.0) * w * w) / viscosity
    late = 0.5 + 0.5 * stiff / (stiff + 6.0)
    inert = viscosity + time * late * law.stiffness
    # what drives the step is weighted to its end as well, or w would lag by half a step
    known = push + time * late * alpha * w + (late - 0.5) * stretch.outer * faster
    share = time * late * alpha

    def excess(run: State) -> State:
        return inert * run + share * flow(w, run) - known

    def slope(run: State) -> State:
        return inert + share * _rate(law, run, flow(w, run))

    first = push / (inert + share * _rate(law, push, w))
    run = _root(excess, slope, first, (known - share) / inert, (known + share) / inert)
    return u + run, flow(w, run)


def _rate(law: SeriesLaw, run: State, w: State) -> State:
    """|dw/du| in the direction of a run, 1/m."""
    y = jnp.where(run >= 0.0, 1.0, -1.0) * w
    return law.rho * (1.0 + jnp.where(y < 0.0, 2.0 * law.sigma - 1.0, -1.0) * y * y)


def _root(excess: Curve, slope: Curve, first: State, low: State, high: State) -> State:
    """Where the growing function `excess` vanishes between two bounds."""

    def newton(_: Array, carry: tuple[State, State, State]) -> tuple[State, State, State]:
        run, low, high = carry
        over = excess(run)
        low, high = jnp.where(over < 0.0, run, low), jnp.where(over > 0.0, run, high)
        better = run - over / slope(run)
        inside = (better >= low) & (better <= high)
        return jnp.where(inside, better, 0.5 * (low + high)), low, high

    start = jnp.clip(first, low, high)
    run, _, _ = jax.lax.fori_loop(0, NEWTON, newton, jax.lax.stop_gradient((start, low, high)))
    run = jax.lax.stop_gradient(run)
    # a last step with a fixed slope carries the derivatives of the root
    return run - excess(run) / jax.lax.stop_gradient(slope(run))


def _travelled(stretch: Stretch, part: float) -> State:
    """Travel of x from the start of a stretch by the cubic with its velocities at both ends."""
    a, b = stretch.enter, stretch.leave
    t = part
    return (
        (3.0 * t**2 - 2.0 * t**3) * stretch.travel + (t - 2.0 * t**2 + t**3) * a + (t**3 - t**2) * b
    )


def _speed(stretch: Stretch, part: float) -> State:
    """Velocity of x times the length of the stretch, m: the derivative of `_travelled`."""
    a, b, t = stretch.enter, stretch.leave, part
    return (
        6.0 * t * (1.0 - t) * stretch.travel
        + (1.0 - 4.0 * t + 3.0 * t**2) * a
        + (3.0 * t**2 - 2.0 * t) * b
    )
