"""The bi-viscous element along a whole motion: where it switches, its steady cycle, derivatives.

Every step is taken branch by branch, from switch to switch, each switch located in time.  As χ is
continuous, the state after a step does not change, to first order, when a switch is moved.  So
with switches held where they are the motion is a chain of affine maps, and the derivatives of that
chain are exactly those of the motion.

The steady cycle is the fixed point of the map over one cycle, by Newton's method on the two states.
"""

from functools import partial
from typing import Final, NamedTuple, TypeAlias

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.models.biviscous import Affine, Number, State, Stretch, flow, identity
from sysid.models.biviscous_step import take_apart

Each: TypeAlias = Float[Array, "*batch"]

CYCLES: Final = 20
"""Most steps of Newton's method for the steady cycle."""
CLOSED: Final = 1e-11
"""Relative difference between a cycle's two ends at which it is closed."""


class Run(NamedTuple):
    """A motion, step by step.

    Attributes:
        ends: State after every step, [steps, ...].
        over: The affine map of the whole run at these switches, [...].
        times: s on each branch, [steps, branches, ...].
        branches: Which, [steps, branches, ...].
    """

    ends: State
    over: Affine
    times: Float[Array, "steps branches *batch"]
    branches: Float[Array, "steps branches *batch"]


Slopes: TypeAlias = State
"""Change of a step's end per change of each of its numbers, [numbers, steps, ...]."""


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def follow_biviscous(periodic: bool, stretches: Stretch) -> State:
    """State after every step, [steps, ...].

    Args:
        periodic: The steps are one whole cycle of a steady motion; otherwise it starts from rest.
        stretches: [steps, ...].
    """
    return _solved(periodic, stretches)[1].ends


@follow_biviscous.defjvp
def _follow_jvp(
    periodic: bool, primals: tuple[Stretch], tangents: tuple[Stretch]
) -> tuple[State, State]:
    start, run = _solved(periodic, *primals)
    steps, slopes = _linearised(start, run, *primals)
    return run.ends, _pushed(periodic, steps, run.over, slopes, *tangents)


def _solved(periodic: bool, stretches: Stretch) -> tuple[State, Run]:
    """State at the start, and the run from there."""
    first: Stretch = jax.tree.map(lambda z: z[0], stretches)
    rest = State(jnp.zeros_like(first.time), jnp.zeros_like(first.time))
    if not periodic:
        return rest, _run(rest, stretches)
    element = first.element
    branch = jnp.where(jnp.abs(first.v_0) > element.yield_velocity, jnp.sign(first.v_0), 0.0)
    resisting = element.damping(branch) * first.v_0 + branch * element.yielding
    guess = State(resisting / element.stiffness, first.v_0)
    shape = jax.eval_shape(_run, guess, stretches)
    empty: Run = jax.tree.map(lambda z: jnp.zeros(z.shape, z.dtype), shape)

    def unclosed(carry: tuple[jax.Array, State, State, Run, jax.Array]) -> jax.Array:
        return carry[4] & (carry[0] < CYCLES)

    def cycle(
        carry: tuple[jax.Array, State, State, Run, jax.Array],
    ) -> tuple[jax.Array, State, State, Run, jax.Array]:
        count, _, start, _, _ = carry
        run = _run(start, stretches)
        end: State = jax.tree.map(lambda z: z[-1], run.ends)
        ajar = jnp.asarray(False)
        for reached, begun, path in zip(end, start, run.ends, strict=True):
            size = jnp.max(jnp.abs(path), axis=0)
            ajar = ajar | jnp.any(jnp.abs(reached - begun) > CLOSED * size)
        return count + 1, start, _closed(run.over, start, end), run, ajar

    carry = (jnp.asarray(0), guess, guess, empty, jnp.asarray(True))
    _, start, _, run, _ = jax.lax.while_loop(unclosed, cycle, carry)
    return start, run


def _closed(over: Affine, start: State, end: State) -> State:
    """Newton's step to the fixed point of a map whose linear part is that of `over`."""
    u, w = end.u - start.u, end.w - start.w
    a, b, c, d = 1.0 - over.uu, -over.uw, -over.wu, 1.0 - over.ww
    scale = a * d - b * c
    return State(start.u + (d * u - b * w) / scale, start.w + (a * w - c * u) / scale)


def _run(start: State, stretches: Stretch) -> Run:
    """Through all steps from a state."""

    def step(
        carry: tuple[State, Affine], stretch: Stretch
    ) -> tuple[tuple[State, Affine], tuple[State, Number, Number]]:
        state, over = carry
        pieces = take_apart(stretch, state)
        end = pieces.over(state)
        return (end, pieces.over.after(over)), (end, pieces.times, pieces.branches)

    (_, over), (ends, times, branches) = jax.lax.scan(step, (start, identity(start.u)), stretches)
    return Run(ends, over, times, branches)


def _linearised(start: State, run: Run, stretches: Stretch) -> tuple[Affine, Slopes]:
    """Every step as a map of the state before it, and how its end depends on the step's numbers."""
    before = State(
        *(jnp.concatenate([z[None], end[:-1]]) for z, end in zip(start, run.ends, strict=True))
    )
    numbers, kind = jax.tree.flatten(stretches)
    used = jnp.max(jnp.sum(run.times > 0.0, axis=1))

    def over(numbers: list[Number]) -> Affine:
        now: Stretch = jax.tree.unflatten(kind, numbers)

        def on_branch(k: jax.Array, carry: tuple[Affine, Number]) -> tuple[Affine, Number]:
            whole, since = carry
            branch, time = run.branches[:, k], run.times[:, k]
            return flow(now, branch, since, time).after(whole), since + time

        begin = (identity(now.time), jnp.zeros_like(now.time))
        return jax.lax.fori_loop(0, used, on_branch, begin)[0]

    def slope(unit: Number) -> State:
        directions = [one * jnp.ones_like(z) for one, z in zip(unit, numbers, strict=True)]
        return jax.jvp(lambda z: over(z)(before), (numbers,), (directions,))[1]

    return over(numbers), jax.vmap(slope)(jnp.eye(len(numbers)))


def _pushed(
    periodic: bool, steps: Affine, whole: Affine, slopes: Slopes, tangent: Stretch
) -> State:
    """Change of every end for a change of the steps' numbers."""
    numbers = jax.tree.leaves(tangent)
    u, w = (
        jnp.sum(jnp.stack([s * z for s, z in zip(slope, numbers, strict=True)]), axis=0)
        for slope in slopes
    )
    chain = steps._replace(u=u, w=w)
    start = State(jnp.zeros_like(u[0]), jnp.zeros_like(u[0]))
    if periodic:
        end: State = jax.tree.map(lambda z: z[-1], _chain(chain, start))
        start = _closed(whole, start, end)
    return _chain(chain, start)


def _chain(steps: Affine, start: State) -> State:
    """State after every step."""

    def step(state: State, over: Affine) -> tuple[State, State]:
        state = over(state)
        return state, state

    return jax.lax.scan(step, start, steps)[1]
