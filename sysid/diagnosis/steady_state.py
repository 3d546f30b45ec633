"""The tests without effects that their cycles showed, and these effects as causes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.data.cycles import noise_floor
from sysid.data.loops import Loops
from sysid.diagnosis.bases import Base
from sysid.diagnosis.cycle_evidence import cycle_numbers
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.held_out import gain_of
from sysid.diagnosis.result import Cause, Gain, strongest_first
from sysid.diagnosis.within_tests import Within, look_within
from sysid.diagnosis.words import capital
from sysid.effects.base import AbstractEffect
from sysid.models.base import AbstractValve
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.motion.history import RunHistory, into_cycle
from sysid.motion.motion import Motion, loop_motion

_WITHOUT: Final = {
    "first_cycle_breakaway": "in the steady state after the first cycles",
    "self_heating": "in oil at the temperature at which each test began",
}


@dataclass(frozen=True)
class Removed:
    """Effects that were taken out of the tests.

    Attributes:
        found: What the cycles said of each, the strongest first.
        forces: N, RMS over the campaign of what each adds to the mean over cycles.
        loops: The tests without them: in the state that they would have had from the start.
        bases: Base models, fitted to the tests as they were.
    """

    found: tuple[Within, ...]
    forces: tuple[float, ...]
    loops: Loops
    bases: tuple[Base, ...]

    def base_like(self, base: Base) -> Base:
        """The same base model, or the best one, fitted to the tests as they were."""
        same = [b for b in self.bases if b.fit.model == base.fit.model]
        return next((b for b in same if b.fit.variant == base.fit.variant), self.bases[0])


def take_out(
    loops: Loops, history: RunHistory | None, bases: tuple[Base, ...], seed: int
) -> tuple[Within, Removed | None]:
    """Look for effects in the cycles, and take out one after the other.

    Args:
        loops: L tests.
        history: Of the L tests, if their order is known.
        bases: Base models of these tests, best first.
        seed: Of the halves.

    Returns:
        What the cycles say, all effects together, and the tests without them; None if there are
        none.
    """
    best = bases[0]
    valve = valve_at(best.free.coordinates, jnp.asarray(best.free.u)).valve
    first = within = look_within(best.evidence, valve, seed)
    removed = None
    while within.effect is not None:
        loops, force = without(loops, valve, within.effect)
        removed = Removed(
            found=(*(removed.found if removed else ()), within),
            forces=(*(removed.forces if removed else ()), force),
            loops=loops,
            bases=bases,
        )
        points = best.evidence.force.shape[1]
        within = look_within(gather(loops, history, points), valve, seed)
        if any(set(w.members) & set(within.members) for w in removed.found):
            break
    return (first if removed is None else _together(first, removed.found)), removed


def _together(first: Within, found: Sequence[Within]) -> Within:
    """The first look, with the scores of effects that were found later."""
    rows = {row.id: row for row in first.screen}
    for within in found[1:]:
        rows |= {row.id: row for row in within.screen if row.id in within.members}
    members = tuple(m for within in found for m in within.members)
    return replace(first, screen=tuple(rows.values()), members=members)


def without(loops: Loops, valve: AbstractValve, effect: AbstractEffect) -> tuple[Loops, float]:
    """Take what an effect adds out of every cycle of every test.

    Args:
        loops: L tests.
        valve: The base model with which the effect was identified.
        effect: As identified.

    Returns:
        The tests without it, and what it adds to the mean over cycles: N, RMS over the campaign.
    """
    each = [
        np.arange(count) if len(d) != count else cycle_numbers(d)
        for count, d in zip(loops.cycles, loops.deviations, strict=True)
    ]
    most = max(int(numbers.max()) + 1 for numbers in each)
    into = jnp.asarray(into_cycle(loops, loops.force.shape[1]))
    numbers = jnp.arange(float(most))
    added = np.asarray(_added(valve, effect, loop_motion(loops), into, numbers))
    mean = np.stack([added[n, k].mean(axis=0) for k, n in enumerate(each)])
    deviations = tuple(
        d - (added[n, k] - added[n, k].mean(axis=0))
        for k, (d, n) in enumerate(zip(loops.deviations, each, strict=True))
    )
    steady = replace(
        loops,
        force=loops.force - mean,
        deviations=deviations,
        noise_floor=np.array([noise_floor(d) for d in deviations]),
    )
    return steady, float(np.sqrt(np.mean(mean**2)))


@eqx.filter_jit
def _added(
    valve: AbstractValve,
    effect: AbstractEffect,
    motion: Motion,
    into: Array,
    numbers: Float[Array, " cycle"],
) -> Float[Array, "cycle loop phase"]:
    """What an effect adds in each cycle of a test, N."""
    plain = valve.force(motion)

    def one(number: Array) -> Array:
        return Damper(valve, (effect,)).force(replace(motion, cycle=number + into)) - plain

    return jax.lax.map(one, numbers)


def with_removed(removed: Removed, best: Extended, causes: Sequence[Cause]) -> tuple[Cause, ...]:
    """The causes with those that were taken out; shares are of what all of them remove."""
    energy = [
        b.evidence.energy(state.gls.residual)
        for b, state in (
            (removed.base_like(best.base), removed.base_like(best.base).free),
            (best.base, best.base.free),
            (best.base, best.free if causes else best.base.free),
        )
    ]
    total = max(energy[0] - energy[2], 1e-300)
    share = float(np.clip((energy[0] - energy[1]) / total, 0.0, 1.0))
    others = [replace(c, share=c.share * (1.0 - share)) for c in causes]
    square = np.array(removed.forces) ** 2
    parts = share * square / max(float(square.sum()), 1e-300)
    taken = zip(removed.found, removed.forces, parts.tolist(), strict=True)
    every = [*(_cause(within, force, part) for within, force, part in taken), *others]
    return strongest_first(every)


def _cause(within: Within, force: float, share: float) -> Cause:
    assert within.effect is not None
    facts = within.effect.facts
    several = len(within.members) > 1
    test = facts.separating_test
    row = next(r for r in within.screen if r.id == facts.id)
    return Cause(
        status="class" if several else "named",
        id=facts.id,
        members=within.members,
        family=facts.family,
        effect=within.effect,
        parameters=within.parameters,
        confidence=within.confidence,
        score=row.score,
        share=share,
        extra_error=force,
        because=(
            f"Over the cycles of {within.tests} tests, {facts.id} raises the log-likelihood of "
            f"what changes from one to the next by {within.gain:.0f}, anything "
            f"{'outside of this class' if several else 'else'} by "
            f"{max(within.gain - within.behind, 0.0):.0f} at most"
        ),
        separating_test=capital(test) if several else None,
        stability=within.stability,
        from_cycles=True,
    )


def whole_gain(removed: Removed, best: Extended, gain: Gain | None) -> Gain:
    """What all causes are worth: from the base on the tests as they were to the last model.

    The effect that was taken out is itself known from all tests; its one size and one shape take
    little from what is held out.
    """
    evidence, raw = best.base.evidence, removed.base_like(best.base)
    after = best.base.held_out if gain is None else gain.per_test_after
    return gain_of(evidence, raw.held_out, after, () if gain is None else gain.extrapolation)


def told(within: Within, removed: Removed | None) -> tuple[str, ...]:
    """What was done to the tests, and what their cycles leave open."""
    if removed is not None:
        ids = [w.members[0] for w in removed.found]
        return tuple(
            f"{id} was found in the cycles of the tests, and what it adds was taken out of every "
            f"cycle: all else here, and card.json, is of the damper {_WITHOUT[id]}."
            for id in ids
        )
    if within.unnamed is not None:
        return (
            "Within tests the force changes from cycle to cycle in a way that no effect of the "
            f"catalogue has; it is most like {within.unnamed}.",
        )
    return ()
