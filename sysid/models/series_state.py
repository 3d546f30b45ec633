"""An element with hysteresis in series with a dashpot, a leak and a spring.

The travel u of the element and its state w obey

    F' = α w + c_0 u̇ + k_0 u,    u̇ = e ẋ − μ F' − s' Ḟ',    dw/du by an exact flow

where μ is what dashpot and leak give way, m/(s·N).  With a spring of compliance s ahead of all and
a stiffness k_1 beside, e = 1/(1 + k_1 s) and s' = e s.

Both are stiff wherever w changes.  Each step solves one scalar equation for the travel Δu, with w
at the end of the step by its exact flow; the weight of the end grows from the trapezium's 1/2
towards backward Euler's 1 as the step becomes stiff.  Ḟ' is a backward difference.
"""

from collections.abc import Callable
from typing import Final, NamedTuple, TypeAlias

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.backward_differences import differences_of
from sysid.models.internal_state import Flow, bouc_wen_flow, dahl_flow, turning_start
from sysid.motion.motion import Motion

State: TypeAlias = Float[Array, "*batch"]
Curve: TypeAlias = Callable[[State], State]
Number: TypeAlias = Float[Array, "..."]

STEPS_A_CYCLE: Final = 144
"""Fewest steps of a steady loop; coarser grids are divided."""
NEWTON: Final = 8
"""Newton's steps for Δu; the equation is monotone and its root bracketed."""


class SeriesElement(eqx.Module):
    """The element's numbers; those marked [..., c] may change along the motion, c = n or 1.

    Attributes:
        yielding: α, N, [..., c].
        inner: c_0, N·s/m, [..., c].
        mobility: μ, m/(s·N), [..., c].
        stiffness: k_0, N/m; None where the element has no spring.
        rho: ρ, 1/m, [..., c].
        sigma: σ of Bouc and Wen's flow; None for Dahl's.
        follows: e, share of the motion that a stiffness beside leaves to the spring's end.
        compliance: s', m/N; None where there is no spring ahead.
    """

    yielding: Number
    inner: Number
    mobility: Number
    stiffness: Number | None
    rho: Number
    sigma: Number | None
    follows: Number | float = 1.0
    compliance: Number | float | None = None

    def flow(self, rho: State) -> Flow:
        """Of w over a run of u."""
        return dahl_flow(rho) if self.sigma is None else bouc_wen_flow(rho, self.sigma)

    def rate(self, rho: State, run: State, w: State) -> State:
        """|dw/du| in the direction of a run, 1/m."""
        y = jnp.where(run >= 0.0, 1.0, -1.0) * w
        if self.sigma is None:
            return rho * (1.0 - y)
        return rho * (1.0 + jnp.where(y < 0.0, 2.0 * self.sigma - 1.0, -1.0) * y * y)

    def mean_rate(self, rho: State, w: State) -> State:
        """Mean of both directions, 1/m: a turn inside a step must not make the force jump."""
        return rho if self.sigma is None else rho * (1.0 + (self.sigma - 1.0) * w * w)

    def rate_at(self, velocity: Number, u: Number, w: Number) -> Number:
        """u̇ while the spring ahead carries a steady force, m/s."""
        through = self.yielding * w + self.held(u)
        return (self.follows * velocity - self.mobility * through) / (
            1.0 + self.inner * self.mobility
        )

    def held(self, u: State) -> State | float:
        """Force of the element's spring, N."""
        return 0.0 if self.stiffness is None else self.stiffness * u


class Stretch(eqx.Module):
    """One step of the grid for every test of the batch, [...] each.

    Attributes:
        time: s.
        travel: m, of e x.
        enter: m, travel at the first velocity.
        leave: m, travel at the last.
        yielding: α at the end, N.
        inner: c_0 at the end, N·s/m.
        mobility: μ at the end, m/(s·N).
        rho: ρ at the end, 1/m.
        differences: Four coefficients of a backward difference at the end, 1/s; none without a
            spring.
    """

    time: State
    travel: State
    enter: State
    leave: State
    yielding: State
    inner: State
    mobility: State
    rho: State
    differences: tuple[State, ...]


class Followed(NamedTuple):
    """The element as it moves; [...], or [..., n] along a motion.

    Attributes:
        travel: u, m.
        state: w.
        rate: u̇, m/s.
        carried: The newest three values of F', N; none without a spring.
    """

    travel: State
    state: State
    rate: State
    carried: tuple[State, ...]


Cycle: TypeAlias = Callable[[Followed], tuple[Followed, Followed]]
"""State when a cycle begins → state when it ends, and after each step."""
Between: TypeAlias = Callable[[Followed, Followed, Followed, Array], Followed]
"""Where the next cycle begins: from the start, end, steps and number of the last one."""


def follow_in_series(element: SeriesElement, motion: Motion) -> Followed:
    """The element on a motion, [..., n] each.

    Steady loops are those of the periodic state; any other motion starts at w = 0 and u = 0.
    """
    x = motion.displacement
    stretches = _stretches(element, motion)
    parts = max(1, -(-STEPS_A_CYCLE // x.shape[-1])) if motion.periodic else 1

    def run(start: Followed) -> tuple[Followed, Followed]:
        def over(state: Followed, stretch: Stretch) -> tuple[Followed, Followed]:
            def part(state: Followed, k: Array) -> tuple[Followed, None]:
                return _step(element, stretch, state, k / parts, (k + 1) / parts), None

            if parts == 1:
                state = _step(element, stretch, state, 0.0, 1.0)
            else:  # a loop: written out, its derivatives take several times as long, to compile too
                state = jax.lax.scan(part, state, jnp.arange(parts))[0]
            return state, state

        return jax.lax.scan(over, start, stretches)

    def along(signal: Array) -> Array:
        return jnp.moveaxis(signal, 0, -1)

    if motion.periodic:
        ends = _steady(element, motion, run)
        return jax.tree.map(lambda z: along(jnp.roll(z, 1, axis=0)), ends)
    none = jnp.zeros(x.shape[:-1])
    start = _started(element, motion, none, none)
    ends = run(start)[1]
    return jax.tree.map(lambda a, b: along(jnp.concatenate([a[None], b])), start, ends)


def _started(element: SeriesElement, motion: Motion, u: State, w: State) -> Followed:
    """With a force that does not change yet."""
    first = SeriesElement(
        yielding=_first(element.yielding, motion),
        inner=_first(element.inner, motion),
        mobility=_first(element.mobility, motion),
        stiffness=element.stiffness,
        rho=_first(element.rho, motion),
        sigma=element.sigma,
        follows=element.follows,
    )
    rate = first.rate_at(motion.velocity[..., 0], u, w)
    held = first.yielding * w + first.held(u)
    none = element.compliance is None
    return Followed(u, w, rate, () if none else (held + first.inner * rate,) * 3)


def _first(number: Number, motion: Motion) -> State:
    return jnp.broadcast_to(number, motion.velocity.shape)[..., 0]


def _steady(element: SeriesElement, motion: Motion, run: Cycle) -> Followed:
    """A cycle of the steady loop, the state after each step.

    The mean of u decays slowly, at the rate k_0 ν.  So u is centred after a first cycle, as it is
    in a symmetric loop; where harmonics make it otherwise, what it loses in a second cycle tells
    how far it still has to go.  Without a spring in the element the place of u does not matter.
    """
    x = motion.displacement
    none = jnp.zeros(x.shape[:-1])
    if element.stiffness is None:
        w = turning_start(element.flow(_first(element.rho, motion)), motion.path)
        start = _started(element, motion, none, w)
        return _last_cycle(run, start, 2, lambda begun, ended, history, cycle: ended)
    inner, mobility = _first(element.inner, motion), _first(element.mobility, motion)
    nu = mobility / (1.0 + inner * mobility)
    kept = jnp.exp(-element.stiffness * nu / motion.frequency[..., 0])
    reach = jnp.abs(x).max(axis=-1)

    def shifted(begun: Followed, ended: Followed, history: Followed, cycle: Array) -> Followed:
        centre = 0.5 * (history.travel.max(axis=0) + history.travel.min(axis=0))
        missing = (ended.travel - begun.travel) / jnp.maximum(1.0 - kept, 1e-6)
        there = begun.travel + jnp.clip(missing, -reach, reach)
        by = jnp.where(cycle == 0, -centre, there - ended.travel)
        return ended._replace(travel=ended.travel + by, rate=ended.rate - nu * element.held(by))

    return _last_cycle(run, _started(element, motion, x[..., 0], none), 3, shifted)


def _last_cycle(run: Cycle, start: Followed, cycles: int, between: Between) -> Followed:
    """The last of some cycles: a loop, since each one written out is compiled again."""

    def cycle(carry: tuple[Followed, Followed], k: Array) -> tuple[tuple[Followed, Followed], None]:
        begun, _ = carry
        ended, history = run(begun)
        return (between(begun, ended, history, k), history), None

    blank = jax.eval_shape(run, start)[1]
    empty = jax.tree.map(lambda z: jnp.zeros(z.shape, z.dtype), blank)
    (_, history), _ = jax.lax.scan(cycle, (start, empty), jnp.arange(cycles))
    return history


def _stretches(element: SeriesElement, motion: Motion) -> Stretch:
    """The steps of the grid, [n or n − 1, ...]."""
    x = motion.displacement
    v, strides = element.follows * motion.velocity, element.follows * motion.strides
    laws = [
        jnp.broadcast_to(z, x.shape)
        for z in (element.yielding, element.inner, element.mobility, element.rho)
    ]
    spring = element.compliance is not None
    differences = tuple(differences_of(motion).first) if spring else ()
    if motion.periodic:
        n = x.shape[-1]
        time = jnp.broadcast_to(1.0 / (n * motion.frequency), x.shape)
        after = [jnp.roll(z, -1, axis=-1) for z in (v, *laws)]
        travel, now_v = strides, v
    else:
        time = jnp.broadcast_to(jnp.diff(motion.time, axis=-1), x[..., 1:].shape)
        after = [z[..., 1:] for z in (v, *laws)]
        travel, now_v = strides[..., :-1], v[..., :-1]
        differences = tuple(z[..., 1:] for z in differences)
    new_v, *laws = after
    rows = (time, travel, now_v * time, new_v * time, *laws)
    return Stretch(
        *(jnp.moveaxis(z, -1, 0) for z in rows),
        differences=tuple(jnp.moveaxis(z, -1, 0) for z in differences),
    )


def _step(
    element: SeriesElement,
    stretch: Stretch,
    state: Followed,
    begin: float | Scalar,
    end: float | Scalar,
) -> Followed:
    """From `begin` to `end`, in parts of a stretch."""
    part = end - begin
    u, w = state.travel, state.state
    alpha, inner, rho = stretch.yielding, stretch.inner, stretch.rho
    flow = element.flow(rho)
    time = part * stretch.time
    travel = _travelled(stretch, end) - _travelled(stretch, begin)
    v_0, v_1 = (_speed(stretch, z) * part for z in (begin, end))
    mu, pull = stretch.mobility, jnp.zeros_like(time)
    if element.compliance is not None:
        newest, *older = [element.compliance * d / part for d in stretch.differences]
        mu = mu + newest
        pull = sum((d * f for d, f in zip(older, state.carried, strict=True)), start=pull)
    whole = 1.0 + inner * mu
    nu = mu / whole
    stiff = time * alpha * element.mean_rate(rho, w) * nu
    late = 0.5 + 0.5 * stiff / (stiff + 6.0)
    # u̇ weighted to the end of the step, but for what is known of its course: that of x
    drive = v_1 - time * pull
    known = (1.0 - late) * time * state.rate + (late * drive + travel - 0.5 * (v_0 + v_1)) / whole
    known = known - late * time * nu * element.held(u)
    inert = 1.0 + late * time * nu * (0.0 if element.stiffness is None else element.stiffness)
    share = late * time * nu * alpha

    def excess(run: State) -> State:
        return inert * run + share * flow(w, run) - known

    def slope(run: State) -> State:
        return inert + share * element.rate(rho, run, flow(w, run))

    push = known - share * w
    first = push / (inert + share * element.rate(rho, push, w))
    run = _root(excess, slope, first, (known - share) / inert, (known + share) / inert)
    u, w = u + run, flow(w, run)
    held = alpha * w + element.held(u)
    rate = (drive / time - mu * held) / whole
    carried = (held + inner * rate, *state.carried[:-1]) if state.carried else ()
    return Followed(u, w, rate, carried)


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


def _travelled(stretch: Stretch, part: float | Scalar) -> State:
    """Travel from the start of a stretch by the cubic with its velocities at both ends."""
    a, b = stretch.enter, stretch.leave
    t = part
    return (
        (3.0 * t**2 - 2.0 * t**3) * stretch.travel + (t - 2.0 * t**2 + t**3) * a + (t**3 - t**2) * b
    )


def _speed(stretch: Stretch, part: float | Scalar) -> State:
    """Velocity times the length of the stretch, m: the derivative of `_travelled`."""
    a, b, t = stretch.enter, stretch.leave, part
    return (
        6.0 * t * (1.0 - t) * stretch.travel
        + (1.0 - 4.0 * t + 3.0 * t**2) * a
        + (3.0 * t**2 - 2.0 * t) * b
    )
