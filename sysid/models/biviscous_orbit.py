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

Each: TypeAlias = Float[Array, "*batch"]

BRANCHES: Final = 4
"""Most branches in one step; the last one lasts to its end."""
CYCLES: Final = 20
"""Most steps of Newton's method for the steady cycle."""
CLOSED: Final = 1e-11
"""Relative difference between a cycle's two ends at which it is closed."""
LOCATED: Final = 1e-12
"""Parts of a step to which switches are located."""
TRIALS: Final = 60
"""Most steps of the safeguarded Newton method for one switch."""


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


class _Within(NamedTuple):
    """Where a step stands: `taken` branches are done, the next lasts `left` unless it is left."""

    taken: jax.Array
    left: Each
    branch: Each
    done: Affine
    times: Float[Array, "branches *batch"]
    branches: Float[Array, "branches *batch"]


class _Search(NamedTuple):
    """A switch between `low` and `high`, last tried at `time`."""

    trial: jax.Array
    time: Each
    low: Each
    high: Each
    passed: Affine
    open: jax.Array


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
        within = _step(state, stretch)
        end = within.done(state)
        return (end, within.done.after(over)), (end, within.times, within.branches)

    (_, over), (ends, times, branches) = jax.lax.scan(step, (start, identity(start.u)), stretches)
    return Run(ends, over, times, branches)


def _step(state: State, stretch: Stretch) -> _Within:
    """One step, branch by branch."""
    begun = jnp.sign(state.w) * (jnp.abs(state.w) >= stretch.element.yield_velocity)
    none = jnp.zeros((BRANCHES, *state.u.shape))
    begin = _Within(jnp.asarray(0), stretch.time, begun, identity(state.u), none, none)

    def unfinished(within: _Within) -> jax.Array:
        return (within.taken == 0) | (jnp.any(within.left > 0.0) & (within.taken < BRANCHES))

    def advance(within: _Within) -> _Within:
        taken, left, branch, done, times, branches = within
        now = done(state)
        since = stretch.time - left
        through = flow(stretch, branch, since, left)
        following = _next(branch, through(now).w, stretch.element.yield_velocity)
        leaves = (following != branch) & (left > 0.0) & (taken < BRANCHES - 1)
        time, passed = _located(stretch, now, branch, following, since, left, through, leaves)
        return _Within(
            taken + 1,
            jnp.where(leaves, left - time, 0.0),
            jnp.where(leaves, following, branch),
            passed.after(done),
            times.at[taken].set(time),
            branches.at[taken].set(branch),
        )

    return jax.lax.while_loop(unfinished, advance, begin)


def _next(branch: Each, w: Each, yield_velocity: Each) -> Each:
    """The branch that follows if the present one is carried on to velocity w."""
    beyond = jnp.sign(w) * (jnp.abs(w) > yield_velocity)
    return jnp.where(branch == 0.0, beyond, jnp.where(branch * w < yield_velocity, 0.0, branch))


def _located(
    stretch: Stretch,
    now: State,
    branch: Each,
    following: Each,
    since: Each,
    left: Each,
    through: Affine,
    leaves: jax.Array,
) -> tuple[Each, Affine]:
    """How long the branch lasts, and its map; `left` and `through` where it is not left."""
    side = jnp.where(branch == 0.0, following, branch)
    outward = jnp.where(branch == 0.0, side, -side)
    limit = side * stretch.element.yield_velocity

    def unfinished(search: _Search) -> jax.Array:
        return jnp.any(search.open) & (search.trial < TRIALS)

    def advance(search: _Search) -> _Search:
        trial, time, low, high, passed, still = search
        state = passed(now)
        beyond = outward * (state.w - limit)
        rate = outward * stretch.element.acceleration(branch, state)
        low, high = jnp.where(beyond > 0.0, low, time), jnp.where(beyond > 0.0, time, high)
        better = time - beyond / jnp.where(rate == 0.0, 1.0, rate)
        inside = (better > low) & (better < high)
        better = jnp.where(inside, better, 0.5 * (low + high))
        better = jnp.where(still, better, time)
        open_ = still & (jnp.abs(better - time) > LOCATED * stretch.time)
        return _Search(trial + 1, better, low, high, flow(stretch, branch, since, better), open_)

    begin = _Search(jnp.asarray(0), left, jnp.zeros_like(left), left, through, leaves)
    found = jax.lax.while_loop(unfinished, advance, begin)
    return found.time, found.passed


def _linearised(start: State, run: Run, stretches: Stretch) -> tuple[Affine, Slopes]:
    """Every step as a map of the state before it, and how its end depends on the step's numbers."""
    before = State(
        *(jnp.concatenate([z[None], end[:-1]]) for z, end in zip(start, run.ends, strict=True))
    )
    numbers, kind = jax.tree.flatten(stretches)

    def over(numbers: list[Number]) -> Affine:
        now: Stretch = jax.tree.unflatten(kind, numbers)

        def on_branch(
            carry: tuple[Affine, Number], piece: tuple[Number, Number]
        ) -> tuple[tuple[Affine, Number], None]:
            (whole, since), (branch, time) = carry, piece
            return (flow(now, branch, since, time).after(whole), since + time), None

        pieces = (jnp.moveaxis(run.branches, 1, 0), jnp.moveaxis(run.times, 1, 0))
        carry = (identity(now.time), jnp.zeros_like(now.time))
        return jax.lax.scan(on_branch, carry, pieces)[0][0]

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
