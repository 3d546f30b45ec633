"""A spring in series with a stiff damper: the force that both carry.

With s the spring's compliance and Φ the force of the damper for its own motion,

    F = Φ(x_v, v − s Ḟ, a − s F̈)

for a given place x_v behind the spring.

dΦ/dv of a damper reaches 3·10⁵ N·s/m, so F ← Φ(v − s Ḟ) diverges.  Here the derivatives are
backward differences; at each instant Φ is tabulated over velocity, which gives a monotone scalar
equation that a pass through time solves exactly; and Newton's method on all instants at once
polishes the result.  Derivatives with respect to parameters are those of one Newton step at the
solution, which is the implicit function theorem where Φ is pointwise in time.

Source:
    One-step differentiation: J. Bolte, E. Pauwels, S. Vaiter, NeurIPS 2023.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.backward_differences import BackwardDifferences
from sysid.effects.recurrence import solve_recurrence

Signal = Float[Array, "*batch n"]
Each = Float[Array, "*batch 1"]
"""One value a loop."""

Damping = Callable[[Signal, Signal, Signal], Signal]
"""Force from displacement, velocity and acceleration at the damper."""

COARSE: Final = 25
"""Velocities of the first table."""

FINE: Final = (-1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0)
"""Velocities of the others, in spacings of the one before about its solution."""

ROUNDS: Final = 2
"""How often the second table is made, each time about the last solution and finer."""

WIDEST: Final = 1.3
"""Reach of the first table in peak velocities."""

TOLERANCE: Final = 1e-11
MOST_STEPS: Final = 20


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


def series_force(damping: Damping, setting: Setting) -> Signal:
    """Force at every instant, [..., n] N, differentiable once in either mode.

    Args:
        damping: Φ.
        setting: Motion, compliance of the spring, and the difference formulas.
    """
    hoisted, held = jax.closure_convert(damping, *setting[:3])
    frozen_held = jax.lax.stop_gradient(held)

    def frozen(x: Signal, v: Signal, a: Signal) -> Signal:
        return hoisted(x, v, a, *frozen_held)

    still: Setting = jax.lax.stop_gradient(setting._replace(periodic=False))
    still = still._replace(periodic=setting.periodic)
    solved = jax.lax.stop_gradient(_polished(frozen, still, _from_tables(frozen, still)))
    _, newton = _linearised(frozen, still, solved)
    step = newton(hoisted(*setting.behind(solved), *held) - solved)
    return solved + step - jax.lax.stop_gradient(step)


def _from_tables(damping: Damping, setting: Setting) -> Signal:
    """The force to about a per cent of its range, safely."""
    t = jnp.linspace(-1.0, 1.0, COARSE)
    peak = WIDEST * jnp.max(jnp.abs(setting.velocity), axis=-1, keepdims=True)
    spread = t * jnp.sqrt(jnp.abs(t))
    nodes = jnp.stack([jnp.broadcast_to(u * peak, setting.velocity.shape) for u in spread])
    force, velocity, spacing = _march(damping, setting, nodes)
    for _ in range(ROUNDS):
        nodes = jnp.stack([velocity + u * spacing for u in FINE])
        force, velocity, spacing = _march(damping, setting, nodes)
    return force


def _march(
    damping: Damping, setting: Setting, nodes: Float[Array, "k *batch n"]
) -> tuple[Signal, Signal, Signal]:
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
    start = damping(*setting[:3])[..., :1]
    past = jnp.moveaxis(jnp.concatenate([start] * 3, axis=-1), -1, 0)
    if setting.periodic:
        past, _ = jax.lax.scan(step, past, inputs)
    _, found = jax.lax.scan(step, past, inputs)
    force, velocity, spacing = (jnp.moveaxis(z, 0, -1) for z in found)
    return force, velocity, spacing


def _linearised(
    damping: Damping, setting: Setting, force: Signal
) -> tuple[Signal, Callable[[Signal], Signal]]:
    """Residual Φ − F at a force, and the map from a residual to Newton's correction."""
    at = setting.behind(force)
    value, tangent = jax.linearize(damping, *at)
    one, none = jnp.ones_like(force), jnp.zeros_like(force)
    by_v, by_a = tangent(none, one, none), tangent(none, none, one)
    d, e = setting.differences.first, setting.differences.second
    weight = setting.compliance * (by_v * d + by_a * e)
    own = 1.0 + weight[0]
    own = jnp.where(jnp.abs(own) > 1e-3, own, 1e-3)

    def newton(residual: Signal) -> Signal:
        return solve_recurrence(residual / own, -weight[1:] / own, periodic=setting.periodic)

    return value - force, newton


class Search(NamedTuple):
    """Where Newton's method stands: force, next step and how much of it, largest residual."""

    force: Signal
    step: Signal
    share: Each
    error: Each
    taken: jax.Array


def _polished(damping: Damping, setting: Setting, force: Signal) -> Signal:
    """Newton's method on all instants; a step that does not improve a loop is shortened there."""

    def worst(residual: Signal) -> Each:
        return jnp.max(jnp.abs(residual), axis=-1, keepdims=True)

    def begin(f: Signal) -> Search:
        residual, newton = _linearised(damping, setting, f)
        error = worst(residual)
        return Search(f, newton(residual), jnp.ones_like(error), error, jnp.asarray(0))

    def unfinished(state: Search) -> jax.Array:
        open_ = state.error > TOLERANCE * worst(state.force)
        return jnp.any(open_) & (state.taken < MOST_STEPS)

    def advance(state: Search) -> Search:
        trial = state.force + state.share * state.step
        residual, newton = _linearised(damping, setting, trial)
        error = worst(residual)
        better = error < state.error
        return Search(
            jnp.where(better, trial, state.force),
            jnp.where(better, newton(residual), state.step),
            jnp.where(better, jnp.minimum(1.0, 2.0 * state.share), 0.25 * state.share),
            jnp.where(better, error, state.error),
            state.taken + 1,
        )

    return jax.lax.while_loop(unfinished, advance, begin(force)).force
