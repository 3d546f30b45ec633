"""The bi-viscous element along a whole motion: where it switches, its steady cycle, derivatives.

Every step is taken branch by branch, from switch to switch, each switch located in time.  As χ is
continuous, the state after a step does not change, to first order, when a switch is moved.  So
with switches held where they are the motion is a chain of affine maps, and the derivatives of that
chain are exactly those of the motion.

The steady cycle is the fixed point of the map over one cycle, by Newton's method on the two states.

What a number that holds through all steps does to the motion is worked out once, however many
parameters that number depends on.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final, NamedTuple, TypeAlias, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero
from jaxtyping import Array, Float

from sysid.models.biviscous import Affine, Number, State, Stretch, flow, identity, smooth_part
from sysid.models.biviscous_step import take_apart, untouched

Path = TypeVar("Path", State, Affine)

CYCLES: Final = 20
"""Most passes through a cycle in search of the steady one."""
CLOSED: Final = 1e-8
"""Relative difference between a cycle's two ends that is small enough to be taken as linear."""


class Run(NamedTuple):
    """A motion, step by step.

    Attributes:
        ends: State after every step, [steps, ...].
        over: The affine map from the start to every end at these switches, [steps, ...].
        times: s on each branch, [steps, branches, ...].
        branches: Which, [steps, branches, ...].
    """

    ends: State
    over: Affine
    times: Float[Array, "steps branches *batch"]
    branches: Float[Array, "steps branches *batch"]


Slopes: TypeAlias = State
"""Change of a step's end per change of each of its numbers, [numbers, steps, ...]."""


class _Search(NamedTuple):
    """Search of the steady cycle: first half a cycle from a guess, then whole ones.

    `run` began at `start` and does not close where `ajar`; `better` is where to begin next.
    """

    passes: jax.Array
    start: State
    better: State
    run: Run
    ajar: jax.Array


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def follow_biviscous(periodic: bool, stretches: Stretch) -> State:
    """State after every step, [steps, ...].

    Args:
        periodic: The steps are one whole cycle of a steady motion; otherwise it starts from rest.
        stretches: [steps, ...], or [1, ...] where a number of the element holds through all.
    """
    return _solved(periodic, _at_every_step(stretches))[1].ends


def _follow_jvp(
    periodic: bool, primals: tuple[Stretch], tangents: tuple[Stretch]
) -> tuple[State, State]:
    stretches = _at_every_step(*primals)
    start, run = _solved(periodic, stretches)
    changes = {
        place: change
        for place, change in enumerate(jax.tree.leaves(*tangents))
        if not isinstance(change, SymbolicZero)
    }
    steps, slopes = _linearised(start, run, stretches, list(changes))
    follow = partial(_followed, periodic, steps, _last(run.over))
    return run.ends, _pushed(follow, slopes, list(changes.values()))


follow_biviscous.defjvp(_follow_jvp, symbolic_zeros=True)


def _at_every_step(stretches: Stretch) -> Stretch:
    """The same with all numbers at every step."""
    return jax.tree.map(lambda z: jnp.broadcast_to(z, stretches.time.shape), stretches)


def _solved(periodic: bool, stretches: Stretch) -> tuple[State, Run]:
    """State at the start, and the run from there."""
    steps = stretches.time.shape[0]
    if not periodic:
        none = jnp.zeros_like(stretches.time[0])
        return State(none, none), _run(State(none, none), stretches, jnp.asarray(0))
    half = steps // 2
    guess = _without_ringing(jax.tree.map(lambda z: z[half], stretches))
    shape = jax.eval_shape(_run, guess, stretches, half)
    empty: Run = jax.tree.map(lambda z: jnp.zeros(z.shape, z.dtype), shape)

    def unclosed(search: _Search) -> jax.Array:
        return search.ajar & (search.passes < CYCLES)

    def cycle(search: _Search) -> _Search:
        passes, start = search.passes, search.better
        warming = passes == 0
        run = _run(start, stretches, jnp.where(warming, half, 0))
        end, over = _last(run.ends), _last(run.over)
        better = jax.tree.map(partial(jnp.where, warming), end, _closed(over, start, end))
        ajar = warming
        for reached, begun, path in zip(end, start, run.ends, strict=True):
            size = jnp.max(jnp.abs(path), axis=0)
            ajar = ajar | jnp.any(jnp.abs(reached - begun) > CLOSED * size)
        return _Search(passes + 1, start, better, run, ajar)

    begin = _Search(jnp.asarray(0), guess, guess, empty, jnp.asarray(True))
    found = jax.lax.while_loop(unclosed, cycle, begin)
    return found.better, _moved(found.run, found.start, found.better)


def _moved(run: Run, start: State, better: State) -> Run:
    """A run from a start that is so little better that no switch need be moved."""
    u, w = better.u - start.u, better.w - start.w
    over, ends = run.over, run.ends
    ends = State(ends.u + over.uu * u + over.uw * w, ends.w + over.wu * u + over.ww * w)
    return run._replace(ends=ends)


def _without_ringing(stretch: Stretch) -> State:
    """State when a step begins, on the branch of the piston's velocity and free of transients."""
    yielded = jnp.abs(stretch.v_0) > stretch.element.yield_velocity
    branch = jnp.where(yielded, jnp.sign(stretch.v_0), 0.0)
    none = jnp.zeros_like(branch)
    return smooth_part(stretch, branch, none).at(none)


def _last(path: Path) -> Path:
    """Of what there is for every step."""
    return jax.tree.map(lambda z: z[-1], path)


def _closed(over: Affine, start: State, end: State) -> State:
    """Newton's step to the fixed point of a map whose linear part is that of `over`."""
    u, w = end.u - start.u, end.w - start.w
    a, b, c, d = 1.0 - over.uu, -over.uw, -over.wu, 1.0 - over.ww
    scale = a * d - b * c
    return State(start.u + (d * u - b * w) / scale, start.w + (a * w - c * u) / scale)


def _run(start: State, stretches: Stretch, skipped: jax.Array | int) -> Run:
    """Through all steps from a state but some at the beginning, which change nothing."""

    def step(
        carry: tuple[State, Affine], now: tuple[jax.Array, Stretch]
    ) -> tuple[tuple[State, Affine], Run]:
        (state, over), (place, stretch) = carry, now
        pieces = jax.lax.cond(
            place < skipped, lambda: untouched(state), lambda: take_apart(stretch, state)
        )
        end, over = pieces.over(state), pieces.over.after(over)
        return (end, over), Run(end, over, pieces.times, pieces.branches)

    places = jnp.arange(stretches.time.shape[0])
    carry = (start, identity(start.u))
    return jax.lax.scan(step, carry, (places, stretches))[1]


def _linearised(
    start: State, run: Run, stretches: Stretch, places: Sequence[int]
) -> tuple[Affine, Slopes]:
    """Every step as a map of the state before it, and how its end depends on its numbers there."""
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

    return over(numbers), jax.vmap(slope)(jnp.eye(len(numbers))[np.array(places)])


def _pushed(follow: Callable[[State], State], slopes: Slopes, changes: Sequence[Array]) -> State:
    """Change of every end for changes of the steps' numbers.

    Args:
        follow: Change of every end for changes of single steps.
        slopes: Of these, a number each.
        changes: Of the numbers; [1, ...] where it is the same at all steps.
    """
    moving, held = [], []
    for place, change in enumerate(changes):
        alone = State(slopes.u[place], slopes.w[place])
        if change.shape[0] == 1:
            held.append((alone, change))
        else:
            moving.append(jax.tree.map(partial(jnp.multiply, change), alone))
    parts = []
    if moving:
        parts.append(follow(jax.tree.map(lambda *z: jnp.sum(jnp.stack(z), axis=0), *moving)))
    if held:
        alone, change = zip(*held, strict=True)
        each = jax.vmap(follow)(jax.tree.map(lambda *z: jnp.stack(z), *alone))
        sizes = jnp.stack(change)
        parts.append(jax.tree.map(lambda z: jnp.sum(z * sizes, axis=0), each))
    return jax.tree.map(lambda *z: jnp.sum(jnp.stack(z), axis=0), *parts)


def _followed(periodic: bool, steps: Affine, whole: Affine, change: State) -> State:
    """Change of every end when the ends of single steps change."""
    chain = steps._replace(u=change.u, w=change.w)
    start = State(jnp.zeros_like(change.u[0]), jnp.zeros_like(change.w[0]))
    if periodic:
        start = _closed(whole, start, _last(_chain(chain, start)))
    return _chain(chain, start)


def _chain(steps: Affine, start: State) -> State:
    """State after every step."""

    def step(state: State, over: Affine) -> tuple[State, State]:
        state = over(state)
        return state, state

    return jax.lax.scan(step, start, steps)[1]
