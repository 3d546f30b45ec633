"""Travel since the last reversal, as a play operator sees it, step by step."""

from collections.abc import Callable
from typing import Final, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.motion.motion import Motion

Signal = Float[Array, "*batch n"]
Shares = Float[Array, "..."]

ROUNDING: Final = 1e-12
"""Of shares of a step: what engages all the time does so exactly."""


class Part(NamedTuple):
    """Which part of each step counts as travel, from and to which share of it."""

    begin: Signal | float = 0.0
    end: Signal | float = 1.0


WHOLE: Final = Part()


class Steps(NamedTuple):
    """The steps that end at each sample, from the sample before.

    Attributes:
        moved: Change of displacement, m, signed.
        counted: What of it is travel.
        before: Travel in the direction of the step when it starts, m, up to the reach.
        half: Share of the step's travel in the first half of its time.
    """

    moved: Signal
    counted: Part
    before: Signal
    half: Signal | float


def travelled(motion: Motion, reach: Float[Array, ""], counted: Part = WHOLE) -> Steps:
    """Follow a play of width `reach` through the motion.

    Between samples a motion is taken as straight, a cycle as straight in each half of a step: next
    to a reversal, a gap of one or two steps would otherwise be crossed too early.

    Inside the play a piston turns back without using up more than it had gained, so small
    reversals (noise) count for what they are.  Of a cycle the steady state is returned; any other
    motion starts with the play used up in the direction it moves in first.

    Args:
        motion: [..., n].
        reach: Travel beyond which nothing changes, m.
        counted: Which part of each step is travel.
    """
    x = motion.displacement
    moved = x - jnp.roll(x, 1, axis=-1)
    if not motion.periodic:
        moved = moved.at[..., 0].set(0.0)
    reached = 0.5 * reach
    half = _first_half(x, moved) if motion.periodic else 0.5

    def step(offset: jax.Array, change: jax.Array) -> tuple[jax.Array, jax.Array]:
        used = reached + jnp.sign(change) * offset
        return jnp.clip(offset + change, -reached, reached), used

    gone = _gone(counted.end, half) - _gone(counted.begin, half)
    steps = jnp.moveaxis(moved * gone, -1, 0)
    start = _first_direction(moved) * reached
    if motion.periodic:
        start, _ = jax.lax.scan(step, start, steps)
    _, before = jax.lax.scan(step, start, steps)
    return Steps(moved, counted, jnp.moveaxis(before, 0, -1), half)


def _first_direction(moved: Signal) -> Float[Array, "*batch"]:
    """−1 or 1 by the first step that moves, 0 where none does, [...]."""
    first = jnp.argmax(moved != 0.0, axis=-1, keepdims=True)
    return jnp.sign(jnp.take_along_axis(moved, first, axis=-1)[..., 0])


def _first_half(x: Signal, moved: Signal) -> Signal:
    """Share of each step's travel in its first half: of the cubic through four points of a cycle.

    From a quarter (it starts at a reversal) to three quarters (it ends at one).
    """
    beside = jnp.roll(x, 2, axis=-1) + jnp.roll(x, -1, axis=-1)
    middle = (9.0 * (x + jnp.roll(x, 1, axis=-1)) - beside) / 16.0
    still = moved == 0.0
    share = (middle - jnp.roll(x, 1, axis=-1)) / jnp.where(still, 1.0, moved)
    return jnp.clip(jnp.where(still, 0.5, share), 0.25, 0.75)


def _gone(time: Shares | float, half: Shares | float) -> Shares:
    """Share of a step's travel that lies behind at a share of its time."""
    t = jnp.asarray(time)
    return jnp.where(t < 0.5, 2.0 * half * t, half + (2.0 * t - 1.0) * (1.0 - half))


def mean_over_steps(motion: Motion, steps: Steps, integral: Callable[[Signal], Signal]) -> Signal:
    """Mean at each sample of a function of travel, over half a step on either side.

    That is what a loop holds, whose values are means over phase bins, and it makes the result vary
    smoothly with the travel at which something engages, even if that falls between two samples.
    Where the motion is not a cycle the step before is used, and what is to come is not.

    Args:
        motion: [..., n].
        steps: From `travelled`.
        integral: ∫₀ᵀ g dT' of the function g, elementwise; g = 1 where nothing moves or counts.
    """
    if not motion.periodic:  # straight all along
        return _mean(steps, integral, 0.0, 1.0)
    early, late = _mean(steps, integral, 0.0, 0.5), _mean(steps, integral, 0.5, 1.0)
    return 0.5 * (late + jnp.roll(early, -1, axis=-1))


def _mean(steps: Steps, integral: Callable[[Signal], Signal], first: float, last: float) -> Signal:
    """Mean of a function of travel from one share of each step to another, in one of its halves."""
    size = jnp.abs(steps.moved)
    still = size == 0.0
    begin, end = steps.counted
    f, t = (jnp.clip(share, begin, end) for share in (first, last))
    start = _gone(begin, steps.half)
    ahead, behind = (steps.before + size * (_gone(share, steps.half) - start) for share in (t, f))
    pace = 2.0 * size * (steps.half if last <= 0.5 else 1.0 - steps.half)
    gained = integral(ahead) - integral(behind)
    missed = (t - f) - gained / jnp.where(still, 1.0, pace)
    return 1.0 - jnp.where(still | (jnp.abs(missed) < ROUNDING), 0.0, missed) / (last - first)


def strides(motion: Motion, steps: Steps, integral: Callable[[Signal], Signal]) -> Signal:
    """Travel from each sample to the next of what goes with the motion as g says, m.

    Args:
        motion: [..., n].
        steps: From `travelled`.
        integral: Of g over travel, as for `mean_over_steps`.
    """
    size = jnp.abs(steps.moved)
    gone = jnp.sign(steps.moved) * (integral(steps.before + size) - integral(steps.before))
    lost = jnp.roll(gone - steps.moved, -1, axis=-1)
    return motion.strides + lost


def held_still(motion: Motion, share: Signal, travel: Signal) -> Motion:
    """The motion of a valve that goes along only in part; the place stays the rod's.

    So does the acceleration, which decides on forces of inertia alone: what is at rest in the gap
    has the rod's speed at its end, all at once.  That knock has the momentum that the rod's
    acceleration would have given it in the gap, and lower harmonics of the force tell no more.

    Args:
        motion: Of the rod.
        share: Of its velocity.
        travel: From each sample to the next, m.
    """
    together = share if motion.share is None else motion.share * share
    return eqx.tree_at(
        lambda m: (m.velocity, m.travel, m.share),
        motion,
        (motion.velocity * share, travel, together if motion.periodic else None),
        is_leaf=lambda z: z is None,
    )


def mean_force(motion: Motion, force: Callable[[Motion], Signal]) -> Signal:
    """Force of a valve without memory that moves in a share of the time about each sample, N.

    A loop holds means of the force.  Where a valve starts to move between two samples, that is the
    mean of its forces at rest and in motion, while the force at the mean velocity would be most of
    the latter: the step of the force about zero speed is steep.

    Args:
        motion: [..., n], with the share or without.
        force: For any motion.
    """
    g = motion.share
    if g is None:
        return force(motion)
    moves = g > 0.0
    whole = jnp.where(moves, 1.0 / jnp.where(moves, g, 1.0), 0.0)

    def at(factor: Signal | float) -> Motion:
        return eqx.tree_at(
            lambda m: (m.velocity, m.share), motion, (motion.velocity * factor, None)
        )

    return mean_carried(force(at(whole)), g) + (1.0 - g) * force(at(0.0))


def mean_carried(force: Signal, share: Signal) -> Signal:
    """Mean about each point of a cycle of a force that is carried in a share of the time, N.

    Where contact begins or ends between two points, the force is that of the part of the time in
    which there is contact, taken as straight: not the one at the point.  That part is late where
    the share rises from 0 to 1 over the points beside, early where it falls, and about the middle
    where contact is lost and found again between the two.  The slope is that towards the side on
    which there is contact.

    Args:
        force: [..., n] N, at the points; what it is where there is no contact does not matter.
        share: [..., n] of the time about each.
    """
    ahead, behind = jnp.roll(force, -1, axis=-1) - force, force - jnp.roll(force, 1, axis=-1)
    late = jnp.roll(share, -1, axis=-1) - jnp.roll(share, 1, axis=-1)
    slope = late * jnp.where(late > 0.0, ahead, behind)
    return share * (force + 0.5 * (1.0 - share) * slope)


def engaged_beyond(gap: Float[Array, ""], ramp: Signal | float = 0.0) -> Callable[[Signal], Signal]:
    """Integral of g = 0 up to a gap, rising to 1 over a ramp behind it."""

    def integral(travel: Signal) -> Signal:
        beyond = jnp.maximum(travel - gap, 0.0)
        width = jnp.where(jnp.asarray(ramp) > 0.0, ramp, 1.0)
        rising = 0.5 * beyond**2 / width
        return jnp.where(beyond < ramp, rising, beyond - 0.5 * ramp)

    return integral
