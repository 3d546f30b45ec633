"""A spring in series with a stiff damper: the force that both carry.

With s the spring's compliance, w the speed at the damper's valve, Φ the force and V the speed that
damper and leaks beside its valve take up together,

    V(x_v, w, a_v) = v − s Ḟ,   F = Φ(x_v, w, a_v),   a_v = a − s F̈

for a given place x_v behind the spring: the recorded one in a first solution, then the one that
the first solution gives.  Without leaks V = w.

dΦ/dw of a damper reaches 3·10⁵ N·s/m, so F ← Φ(v − s Ḟ) diverges.  Here the derivatives are
backward differences; at each instant V and Φ are tabulated over w, which gives a monotone scalar
equation that a pass through time solves exactly; and Newton's method on all instants at once
polishes the result.  Derivatives with respect to parameters are those of one Newton step at the
solution, which is the implicit function theorem where Φ is pointwise in time.

Source:
    One-step differentiation: J. Bolte, E. Pauwels, S. Vaiter, NeurIPS 2023.
"""

from collections.abc import Callable
from functools import partial
from typing import Final, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.backward_differences import BackwardDifferences
from sysid.effects.recurrence import solve_again, solve_recurrence

Signal = Float[Array, "*batch n"]
Each = Float[Array, "*batch 1"]
"""One value a loop."""

Nodes = Float[Array, "k *batch n"]
"""Velocities of a table."""

Damping = Callable[[Signal, Signal, Signal], tuple[Signal, Signal]]
"""V and Φ, from displacement, w and acceleration at the damper."""

NODES: Final = 13
"""Velocities of a table."""

ROUNDS: Final = 3
"""How often a table is made: over all velocities, then about the last solution and finer."""

WIDEST: Final = 1.3
"""Reach of the first table in peak velocities."""

SOLUTIONS: Final = 2
"""The first one with the recorded place, the second with the place behind the first."""

TOLERANCE: Final = 1e-11
MOST_STEPS: Final = 21
LEAST: Final = 1e-3
"""Slope of a monotone equation below which it is taken to be this."""
TINY: Final = 1e-12
"""m/s, where nothing moves."""


class Setting(NamedTuple):
    """What does not change during a solution, SI: place behind the spring, the rest ahead of it."""

    displacement: Signal
    velocity: Signal
    acceleration: Signal
    compliance: Float[Array, ""]
    differences: BackwardDifferences
    periodic: bool

    def behind(self, force: Signal) -> tuple[Signal, Signal]:
        """Velocity, m/s, and acceleration, m/s², behind the spring when it carries `force`, N."""
        s = self.compliance
        return (
            self.velocity - s * self.differences.rate(force),
            self.acceleration - s * self.differences.curvature(force),
        )

    def lacking(self, damping: Damping, valve: "AtValve") -> tuple[Signal, Signal]:
        """V − (v − s Ḟ), m/s, and Φ − F, N: both zero at the solution."""
        velocity, acceleration = self.behind(valve.force)
        taken_up, force = damping(self.displacement, valve.velocity, acceleration)
        return taken_up - velocity, force - valve.force


class AtValve(NamedTuple):
    """Force and speed at the valve.

    Attributes:
        force: F, N.
        velocity: w, m/s.
    """

    force: Signal
    velocity: Signal


class Newton(NamedTuple):
    """The linear recurrence of Newton's correction at a force.

    Attributes:
        slope: dΦ/dV, N·s/m: what the residual of V counts in force.
        own: −∂(Φ − F)/∂F of an instant's own force.
        memory: Share of the correction that comes from those of the three instants before.
        free: Answers of the recurrence to unit histories.
    """

    slope: Signal
    own: Signal
    memory: Float[Array, "3 *batch n"]
    free: Float[Array, "3 *batch n"]


class Search(NamedTuple):
    """Where Newton's method stands.

    Attributes:
        valve: The best so far.
        step: Newton's correction there.
        newton: Of that correction.
        share: How much of it to take.
        error: Largest residual there, N.
        taken: Steps, a scalar.
    """

    valve: AtValve
    step: AtValve
    newton: Newton
    share: Each
    error: Each
    taken: jax.Array


class Carried(NamedTuple):
    """What the spring carries, and where it puts the damper.

    Attributes:
        displacement: At the damper, as the force was solved with it, m.
        force: N.
    """

    displacement: Signal
    force: Signal


def series_force(damping: Damping, setting: Setting) -> Carried:
    """Force at every instant, differentiable once in either mode.

    Args:
        damping: V and Φ.
        setting: Motion, compliance of the spring, and the difference formulas.
    """
    hoisted, held = jax.closure_convert(damping, *setting[:3])
    frozen_held = jax.lax.stop_gradient(held)

    def frozen(x: Signal, w: Signal, a: Signal) -> tuple[Signal, Signal]:
        return hoisted(x, w, a, *frozen_held)

    def live(x: Signal, w: Signal, a: Signal) -> tuple[Signal, Signal]:
        return hoisted(x, w, a, *held)

    def solve(place: Signal, _: None) -> tuple[Signal, Carried]:
        now = setting._replace(displacement=place)
        still: Setting = jax.lax.stop_gradient(now._replace(periodic=False))
        still = still._replace(periodic=setting.periodic)
        solved, newton = jax.lax.stop_gradient(
            _polished(frozen, still, _from_tables(frozen, still))
        )
        in_velocity, in_force = now.lacking(live, solved)
        residual = in_force - newton.slope * in_velocity
        force = _implicit(setting.periodic, solved.force, newton, residual)
        return setting.displacement - setting.compliance * force, Carried(place, force)

    _, found = jax.lax.scan(solve, setting.displacement, length=SOLUTIONS)
    return jax.tree.map(lambda z: z[-1], found)


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def _implicit(periodic: bool, solved: Signal, newton: Newton, residual: Signal) -> Signal:
    """The solution; its derivative is Newton's correction for that of the residual."""
    del periodic, newton, residual
    return solved


@_implicit.defjvp
def _implicit_jvp(
    periodic: bool,
    primals: tuple[Signal, Newton, Signal],
    tangents: tuple[Signal, Newton, Signal],
) -> tuple[Signal, Signal]:
    solved, newton, _ = primals
    scaled = tangents[2] / newton.own
    return solved, solve_again(scaled, newton.memory, newton.free, periodic=periodic)


def _from_tables(damping: Damping, setting: Setting) -> AtValve:
    """Force and speed to about a per cent of their range, safely."""
    t = jnp.linspace(-1.0, 1.0, NODES).reshape(-1, *[1] * setting.velocity.ndim)
    peak = WIDEST * jnp.max(jnp.abs(setting.velocity), axis=-1, keepdims=True)
    nodes = t * jnp.sqrt(jnp.abs(t)) * peak + jnp.zeros_like(setting.velocity)

    def refine(nodes: Nodes, _: None) -> tuple[Nodes, AtValve]:
        force, velocity, spacing = _march(damping, setting, nodes)
        return velocity + t * spacing, AtValve(force, velocity)

    _, found = jax.lax.scan(refine, nodes, length=ROUNDS)
    return jax.tree.map(lambda z: z[-1], found)


def _march(damping: Damping, setting: Setting, nodes: Nodes) -> tuple[Signal, Signal, Signal]:
    """Go through time (twice through a cycle) with V and Φ read from a table over w.

    Returns:
        Force, speed at the valve, and the spacing of the nodes about it.
    """
    taken_up, table = jax.vmap(lambda w: damping(setting.displacement, w, setting.acceleration))(
        nodes
    )
    s, d = setting.compliance, setting.differences.first

    def step(
        past: jax.Array, now: tuple[jax.Array, ...]
    ) -> tuple[jax.Array, tuple[jax.Array, ...]]:
        v, w, up, phi, coefficients = now
        wanted = v - s * jnp.sum(coefficients[1:] * past, axis=0)
        met = up + s * coefficients[0] * phi
        below = jnp.clip(jnp.sum(met < wanted, axis=0) - 1, 0, w.shape[0] - 2)[None]

        def ends(z: jax.Array) -> tuple[jax.Array, jax.Array]:
            low, high = (jnp.take_along_axis(z, below + k, axis=0)[0] for k in (0, 1))
            return low, high

        (m0, m1), (w0, w1), (f0, f1) = ends(met), ends(w), ends(phi)
        rise = jnp.where(m1 > m0, m1 - m0, 1.0)
        share = jnp.where(m1 > m0, jnp.clip((wanted - m0) / rise, -1.0, 2.0), 0.5)
        f = f0 + share * (f1 - f0)
        return jnp.concatenate([f[None], past[:-1]]), (f, w0 + share * (w1 - w0), w1 - w0)

    inputs = tuple(jnp.moveaxis(z, -1, 0) for z in (setting.velocity, nodes, taken_up, table, d))
    rest = jnp.zeros((3, *setting.velocity.shape[:-1]))
    passes = 2 if setting.periodic else 1
    _, found = jax.lax.scan(lambda past, _: jax.lax.scan(step, past, inputs), rest, length=passes)
    force, velocity, spacing = (jnp.moveaxis(z[-1], 0, -1) for z in found)
    return force, velocity, spacing


def _linearised(
    damping: Damping, setting: Setting, valve: AtValve
) -> tuple[tuple[Signal, Signal], AtValve, Newton]:
    """What V and Φ lack, Newton's correction, and what other corrections need."""
    velocity, acceleration = setting.behind(valve.force)
    (taken_up, value), tangent = jax.linearize(
        lambda w, a: damping(setting.displacement, w, a), valve.velocity, acceleration
    )
    one, none = jnp.ones_like(value), jnp.zeros_like(value)
    by_w, by_a = (
        tuple(z[k] for z in jax.vmap(tangent)(jnp.stack([one, none]), jnp.stack([none, one])))
        for k in (0, 1)
    )
    in_velocity, in_force = taken_up - velocity, value - valve.force
    up = jnp.where(jnp.abs(by_w[0]) > LEAST, by_w[0], LEAST)
    slope = by_w[1] / up
    d, e, s = setting.differences.first, setting.differences.second, setting.compliance
    weight = s * (slope * d + (by_a[1] - slope * by_a[0]) * e)
    own = 1.0 + weight[0]
    own = jnp.where(jnp.abs(own) > LEAST, own, LEAST)
    memory = -weight[1:] / own
    residual = in_force - slope * in_velocity
    step, free = solve_recurrence(residual / own, memory, periodic=setting.periodic)
    rate, curvature = setting.differences.rate(step), setting.differences.curvature(step)
    faster = (s * by_a[0] * curvature - s * rate - in_velocity) / up
    return (in_velocity, in_force), AtValve(step, faster), Newton(slope, own, memory, free)


def _polished(damping: Damping, setting: Setting, start: AtValve) -> tuple[AtValve, Newton]:
    """Newton's method on all instants; a step that does not improve a loop is shortened there."""

    def worst(signal: Signal) -> Each:
        return jnp.max(jnp.abs(signal), axis=-1, keepdims=True)

    typical = worst(start.force) / jnp.maximum(worst(setting.velocity), TINY)

    def unfinished(state: Search) -> jax.Array:
        open_ = state.error > TOLERANCE * worst(state.valve.force)
        return jnp.any(open_) & (state.taken < MOST_STEPS)

    def advance(state: Search) -> Search:
        trial = jax.tree.map(lambda z, step: z + state.share * step, state.valve, state.step)
        (in_velocity, in_force), step, newton = _linearised(damping, setting, trial)
        weight = jnp.maximum(jnp.abs(newton.slope), typical)
        error = worst(jnp.abs(in_force) + weight * jnp.abs(in_velocity))
        better = error < state.error

        def kept(new: jax.Array, old: jax.Array) -> jax.Array:
            return jnp.where(better, new, old)

        return Search(
            jax.tree.map(kept, trial, state.valve),
            jax.tree.map(kept, step, state.step),
            jax.tree.map(kept, newton, state.newton),
            jnp.where(better, jnp.minimum(1.0, 2.0 * state.share), 0.25 * state.share),
            kept(error, state.error),
            state.taken + 1,
        )

    none, one = jnp.zeros_like(start.force), jnp.ones_like(start.force[..., :1])
    three = jnp.zeros((3, *start.force.shape))
    newton = Newton(none, jnp.ones_like(start.force), three, three)
    search = Search(start, AtValve(none, none), newton, one, jnp.inf * one, jnp.asarray(0))
    found = jax.lax.while_loop(unfinished, advance, search)
    return found.valve, found.newton
