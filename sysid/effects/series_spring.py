"""A spring in series with a stiff damper: the force that both carry.

With s the spring's compliance and Φ the force of the damper for its own motion,

    F = Φ(x_v, v − s Ḟ, a − s F̈)

for a given place x_v behind the spring: the recorded one in a first solution, then the one that
the first solution gives.

dΦ/dv of a damper reaches 3·10⁵ N·s/m, so F ← Φ(v − s Ḟ) diverges.  Here the derivatives are
backward differences; at each instant Φ is tabulated over velocity, which gives a monotone scalar
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

Damping = Callable[[Signal, Signal, Signal], Signal]
"""Force from displacement, velocity and acceleration at the damper."""

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


class Setting(NamedTuple):
    """What does not change during a solution: place behind the spring, the rest ahead of it."""

    displacement: Signal
    velocity: Signal
    acceleration: Signal
    compliance: Float[Array, ""]
    differences: BackwardDifferences
    periodic: bool

    def behind(self, force: Signal) -> tuple[Signal, Signal, Signal]:
        """Displacement, velocity and acceleration behind the spring when it carries `force`."""
        s = self.compliance
        return (
            self.displacement,
            self.velocity - s * self.differences.rate(force),
            self.acceleration - s * self.differences.curvature(force),
        )


class Newton(NamedTuple):
    """The linear recurrence of Newton's correction at a force.

    Attributes:
        own: −∂(Φ − F)/∂F of an instant's own force.
        memory: Share of the correction that comes from those of the three instants before.
        free: Answers of the recurrence to unit histories.
    """

    own: Signal
    memory: Float[Array, "3 *batch n"]
    free: Float[Array, "3 *batch n"]


class Search(NamedTuple):
    """Where Newton's method stands.

    Attributes:
        force: The best so far, N.
        step: Newton's correction there, N.
        newton: Of that correction.
        share: How much of it to take.
        error: Largest residual there, N.
        taken: Steps.
    """

    force: Signal
    step: Signal
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
        damping: Φ.
        setting: Motion, compliance of the spring, and the difference formulas.
    """
    hoisted, held = jax.closure_convert(damping, *setting[:3])
    frozen_held = jax.lax.stop_gradient(held)

    def frozen(x: Signal, v: Signal, a: Signal) -> Signal:
        return hoisted(x, v, a, *frozen_held)

    def solve(place: Signal, _: None) -> tuple[Signal, Carried]:
        now = setting._replace(displacement=place)
        still: Setting = jax.lax.stop_gradient(now._replace(periodic=False))
        still = still._replace(periodic=setting.periodic)
        solved, newton = jax.lax.stop_gradient(
            _polished(frozen, still, _from_tables(frozen, still))
        )
        residual = hoisted(*now.behind(solved), *held) - solved
        force = _implicit(setting.periodic, solved, newton, residual)
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


def _from_tables(damping: Damping, setting: Setting) -> Signal:
    """The force to about a per cent of its range, safely."""
    t = jnp.linspace(-1.0, 1.0, NODES).reshape(-1, *[1] * setting.velocity.ndim)
    peak = WIDEST * jnp.max(jnp.abs(setting.velocity), axis=-1, keepdims=True)
    nodes = t * jnp.sqrt(jnp.abs(t)) * peak + jnp.zeros_like(setting.velocity)

    def refine(nodes: Nodes, _: None) -> tuple[Nodes, Signal]:
        force, velocity, spacing = _march(damping, setting, nodes)
        return velocity + t * spacing, force

    _, force = jax.lax.scan(refine, nodes, length=ROUNDS)
    return force[-1]


def _march(damping: Damping, setting: Setting, nodes: Nodes) -> tuple[Signal, Signal, Signal]:
    """Go through time (twice through a cycle) with Φ read from a table over velocity.

    Returns:
        Force, velocity, and the spacing of the nodes about it.
    """
    table = jax.vmap(lambda w: damping(setting.displacement, w, setting.acceleration))(nodes)
    s, d = setting.compliance, setting.differences.first

    def step(
        past: jax.Array, now: tuple[jax.Array, ...]
    ) -> tuple[jax.Array, tuple[jax.Array, ...]]:
        v, w, phi, coefficients = now
        wanted = v - s * jnp.sum(coefficients[1:] * past, axis=0)
        met = w + s * coefficients[0] * phi
        below = jnp.clip(jnp.sum(met < wanted, axis=0) - 1, 0, w.shape[0] - 2)[None]

        def ends(z: jax.Array) -> tuple[jax.Array, jax.Array]:
            low, high = (jnp.take_along_axis(z, below + k, axis=0)[0] for k in (0, 1))
            return low, high

        (m0, m1), (w0, w1), (f0, f1) = ends(met), ends(w), ends(phi)
        rise = jnp.where(m1 > m0, m1 - m0, 1.0)
        share = jnp.where(m1 > m0, jnp.clip((wanted - m0) / rise, -1.0, 2.0), 0.5)
        f = f0 + share * (f1 - f0)
        return jnp.concatenate([f[None], past[:-1]]), (f, w0 + share * (w1 - w0), w1 - w0)

    inputs = tuple(jnp.moveaxis(z, -1, 0) for z in (setting.velocity, nodes, table, d))
    rest = jnp.zeros((3, *setting.velocity.shape[:-1]))
    passes = 2 if setting.periodic else 1
    _, found = jax.lax.scan(lambda past, _: jax.lax.scan(step, past, inputs), rest, length=passes)
    force, velocity, spacing = (jnp.moveaxis(z[-1], 0, -1) for z in found)
    return force, velocity, spacing


def _linearised(damping: Damping, setting: Setting, force: Signal) -> tuple[Signal, Signal, Newton]:
    """Residual Φ − F at a force, Newton's correction, and what other corrections need."""
    value, tangent = jax.linearize(
        lambda v, a: damping(setting.displacement, v, a), *setting.behind(force)[1:]
    )
    one, none = jnp.ones_like(force), jnp.zeros_like(force)
    by_v, by_a = jax.vmap(tangent)(jnp.stack([one, none]), jnp.stack([none, one]))
    d, e = setting.differences.first, setting.differences.second
    weight = setting.compliance * (by_v * d + by_a * e)
    own = 1.0 + weight[0]
    own = jnp.where(jnp.abs(own) > 1e-3, own, 1e-3)
    memory, residual = -weight[1:] / own, value - force
    step, free = solve_recurrence(residual / own, memory, periodic=setting.periodic)
    return residual, step, Newton(own, memory, free)


def _polished(damping: Damping, setting: Setting, force: Signal) -> tuple[Signal, Newton]:
    """Newton's method on all instants; a step that does not improve a loop is shortened there."""

    def worst(residual: Signal) -> Each:
        return jnp.max(jnp.abs(residual), axis=-1, keepdims=True)

    def unfinished(state: Search) -> jax.Array:
        open_ = state.error > TOLERANCE * worst(state.force)
        return jnp.any(open_) & (state.taken < MOST_STEPS)

    def advance(state: Search) -> Search:
        trial = state.force + state.share * state.step
        residual, step, newton = _linearised(damping, setting, trial)
        error = worst(residual)
        better = error < state.error
        return Search(
            jnp.where(better, trial, state.force),
            jnp.where(better, step, state.step),
            jax.tree.map(lambda new, old: jnp.where(better, new, old), newton, state.newton),
            jnp.where(better, jnp.minimum(1.0, 2.0 * state.share), 0.25 * state.share),
            jnp.where(better, error, state.error),
            state.taken + 1,
        )

    none, one = jnp.zeros_like(force), jnp.ones_like(force[..., :1])
    three = jnp.zeros((3, *force.shape))
    newton = Newton(jnp.ones_like(force), three, three)
    start = Search(force, none, newton, one, jnp.inf * one, jnp.asarray(0))
    found = jax.lax.while_loop(unfinished, advance, start)
    return found.force, found.newton
