"""One step of the bi-viscous element, branch by branch, each switch located in time."""

from typing import Final, NamedTuple, TypeAlias

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.models.biviscous import (
    Affine,
    State,
    Stretch,
    flow,
    identity,
    ringing,
    smooth_part,
)

Each: TypeAlias = Float[Array, "*batch"]

BRANCHES: Final = 8
"""Most branches in one step; the last one lasts to its end."""
PROBES: Final = 16
"""Where a step is long and rings, times in it at which a switch is looked for."""
LOCATED: Final = 1e-8
"""A switch is known when Newton's method moves it by less, in parts of a step."""
TRIALS: Final = 60
"""Most steps of the safeguarded Newton method for one switch."""


class Pieces(NamedTuple):
    """A step, taken apart.

    Attributes:
        over: Map of the state over the step, [...].
        times: s on each branch, [branches, ...].
        branches: Which: −1, 0 or 1, [branches, ...].
    """

    over: Affine
    times: Float[Array, "branches *batch"]
    branches: Float[Array, "branches *batch"]


class _Way(NamedTuple):
    """A branch from a time within a step on, to be followed until it is left."""

    stretch: Stretch
    state: State
    branch: Each
    since: Each

    def until(self, time: Each) -> Affine:
        """Map over a time, s."""
        return flow(self.stretch, self.branch, self.since, time)

    def following(self, passed: Affine) -> Each:
        """The branch on which the state belongs when it was carried on by a map."""
        w, limit = passed(self.state).w, self.stretch.element.yield_velocity
        beyond = jnp.sign(w) * (jnp.abs(w) > limit)
        kept = jnp.where(self.branch * w < limit, 0.0, self.branch)
        return jnp.where(self.branch == 0.0, beyond, kept)


class _Exit(NamedTuple):
    """Where a way leads: after `time`, by the map `passed`, the branch is `following`."""

    time: Each
    passed: Affine
    following: Each


class _Within(NamedTuple):
    """Where a step stands: `taken` branches are done, the next lasts `left` if nothing happens."""

    taken: jax.Array
    left: Each
    branch: Each
    pieces: Pieces


class _Search(NamedTuple):
    """A switch between `low` and `high`, last tried at `time`."""

    trial: jax.Array
    time: Each
    low: Each
    high: Each
    passed: Affine
    open: jax.Array


def untouched(state: State) -> Pieces:
    """A step in which nothing happens."""
    none = jnp.zeros((BRANCHES, *state.u.shape))
    return Pieces(identity(state.u), none, none)


def take_apart(stretch: Stretch, state: State) -> Pieces:
    """Follow one step from a state, for every test of a batch.

    Args:
        stretch: The step, [...].
        state: When it begins, [...].
    """
    begun = jnp.sign(state.w) * (jnp.abs(state.w) >= stretch.element.yield_velocity)

    def unfinished(within: _Within) -> jax.Array:
        return (within.taken == 0) | (jnp.any(within.left > 0.0) & (within.taken < BRANCHES))

    def advance(within: _Within) -> _Within:
        taken, left, branch, (over, times, branches) = within
        way = _Way(stretch, over(state), branch, stretch.time - left)
        ahead = _first_exit(way, left)
        leaves = (ahead.following != branch) & (left > 0.0) & (taken < BRANCHES - 1)
        whole = _Exit(left, way.until(left), branch)
        time, passed, following = _located(way, _chosen(leaves, ahead, whole), leaves)
        return _Within(
            taken + 1,
            jnp.where(leaves, left - time, 0.0),
            following,
            Pieces(passed.after(over), times.at[taken].set(time), branches.at[taken].set(branch)),
        )

    begin = _Within(jnp.asarray(0), stretch.time, begun, untouched(state))
    return jax.lax.while_loop(unfinished, advance, begin).pieces


def _chosen(first: jax.Array, one: _Exit, other: _Exit) -> _Exit:
    return jax.tree.map(lambda a, b: jnp.where(first, a, b), one, other)


def _first_exit(way: _Way, left: Each) -> _Exit:
    """The first time at which a branch is seen to have been left; the end if it is not.

    The end alone tells, unless the branch may be left and come back to meanwhile; there it is
    looked for in between.
    """
    through = way.until(left)
    ahead = _Exit(left, through, way.following(through))
    hidden = (left > 0.0) & jnp.where(
        way.branch == 0.0, _may_peak(way, left, ahead), _may_dip(way, left)
    )

    def probe() -> _Exit:
        share = jnp.arange(1, PROBES).reshape(-1, *[1] * left.ndim) / PROBES
        out = way.following(way.until(left * share)) != way.branch
        time = left * (1 + jnp.argmax(out, axis=0)) / PROBES
        passed = way.until(time)
        seen = hidden & jnp.any(out, axis=0)
        return _chosen(seen, _Exit(time, passed, way.following(passed)), ahead)

    return jax.lax.cond(jnp.any(hidden), probe, lambda: ahead)


def _may_dip(way: _Way, left: Each) -> jax.Array:
    """Whether, after yield, ringing can bring the element below v_y and back in the time left."""
    stretch, branch = way.stretch, way.branch
    omega, size = ringing(stretch, branch, way.since, way.state)
    smooth = smooth_part(stretch, branch, way.since)
    slowest = jnp.minimum(branch * smooth.q_0, branch * smooth.at(left).w)
    rates = jnp.abs(jnp.stack([smooth.q_1, smooth.q_1 + 2.0 * smooth.q_2 * left]))
    turns = omega * size > jnp.min(rates, axis=0)
    return (slowest - size < stretch.element.yield_velocity) & turns


def _may_peak(way: _Way, left: Each, ahead: _Exit) -> jax.Array:
    """Whether, before yield, the spring can be loaded up to F_y and relieved in the time left.

    The element all but follows the spring, w ≈ k u / C_pre, so the spring is loaded as long as
    the piston is faster than that.
    """
    element, end = way.stretch.element, ahead.passed(way.state)
    v_0, v_1, v_2 = way.stretch.shifted(way.since)
    creep = element.stiffness / element.pre + element.relief
    begins = v_0 - creep * way.state.u
    ends = v_0 + (v_1 + v_2 * left) * left - creep * end.u
    reach = jnp.maximum(jnp.abs(way.state.u), jnp.abs(end.u))
    reach = reach + jnp.minimum(jnp.abs(begins), jnp.abs(ends)) * left
    held = ahead.following == 0.0
    return held & (begins * ends < 0.0) & (element.stiffness * reach > element.yielding)


def _located(way: _Way, ahead: _Exit, leaves: jax.Array) -> _Exit:
    """The switch before an exit, by Newton's method between bounds; the exit where none is left."""
    side = jnp.where(way.branch == 0.0, ahead.following, way.branch)
    outward = jnp.where(way.branch == 0.0, side, -side)
    element = way.stretch.element
    limit = side * element.yield_velocity

    def unfinished(search: _Search) -> jax.Array:
        return jnp.any(search.open) & (search.trial < TRIALS)

    def advance(search: _Search) -> _Search:
        trial, time, low, high, passed, still = search
        state = passed(way.state)
        beyond = outward * (state.w - limit)
        rate = outward * element.acceleration(way.branch, state)
        low, high = jnp.where(beyond > 0.0, low, time), jnp.where(beyond > 0.0, time, high)
        better = time - beyond / jnp.where(rate == 0.0, 1.0, rate)
        inside = (better > low) & (better < high)
        better = jnp.where(inside, better, 0.5 * (low + high))
        better = jnp.where(still, better, time)
        still = still & (jnp.abs(better - time) > LOCATED * way.stretch.time)
        return _Search(trial + 1, better, low, high, way.until(better), still)

    time, passed, following = ahead
    begin = _Search(jnp.asarray(0), time, jnp.zeros_like(time), time, passed, leaves)
    found = jax.lax.while_loop(unfinished, advance, begin)
    return _Exit(found.time, found.passed, following)
