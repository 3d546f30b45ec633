"""Forward selection of effects with refit, then a backward check.

One effect at a time: of the contenders of a round the one that makes the measurements most probable
is added if it passes.  What is added first can become superfluous; the backward check takes such an
effect out again.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.diagnosis.absorbed import likeness
from sysid.diagnosis.at_once import at_once
from sysid.diagnosis.compiled import make_room
from sysid.diagnosis.contenders import (
    LEAST_GAIN,
    LEAST_IF_RIGHT,
    LIKE_LAWS,
    Contender,
    Round,
    from_first,
    laws_are_right,
    play,
)
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.plain import plainly_fitted, unweighted
from sysid.diagnosis.prototypes import NEED_CYCLES, prototypes
from sysid.diagnosis.remainder import remainder
from sysid.diagnosis.state import State, settle
from sysid.diagnosis.tied import OF_FREQUENCY, frequency_is_varied
from sysid.diagnosis.warmth import warmth_unseen
from sysid.effects.base import AbstractEffect
from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.late import straightened
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates

WEAK: Final = 0.05
"""Part of what the first effect gained that a further one must gain at least: what the first one's
formula misses, being a little different from the damper's own physics, is no second cause."""
AGAIN: Final = 0.5
"""The same for an effect of a family that the model already has: what a formula misses looks most
like its own family."""
UNLIKE: Final = 0.1
"""cos² of two signatures below which the one is nothing that the other's formula misses, though
both are of one family: a preload and its change with temperature."""
OF_LAWS: Final = 0.5
"""Part of what is left that a change of the laws must explain: where laws err, part of the error
always looks like one of them."""
TURNS: Final = 4
"""Times at most that Σ and a fit under it are made of each other."""
STILL: Final = 0.3
"""Distance in standard errors by which such a fit moves at most where it has come to rest."""


@dataclass(frozen=True)
class Selection:
    """What forward selection and backward check came to.

    Attributes:
        base: The model without effects.
        rounds: One for every effect that was added, and the last, in which none was.
        kept: Ids of the effects that stayed.
        final: The model with them.
        evidence: The campaign, with rig errors acting on the force of the final model.
    """

    base: State
    rounds: tuple[Round, ...]
    kept: tuple[str, ...]
    final: State
    evidence: Evidence


def select(
    evidence: Evidence,
    base: State,
    *,
    most: int,
    progress: Callable[[str], None],
) -> Selection:
    """Add effects while they pay.

    Args:
        evidence: The campaign.
        base: The base model, fitted.
        most: Effects to add at most.
        progress: Called with a line a round.
    """
    known = prototypes(evidence.size, ("loops", "history"))
    thermal = valve_at(base.coordinates, jnp.asarray(base.u)).valve.thermal
    candidates = [e for e in known if between_tests(e, evidence, thermal=thermal)]
    state, rounds, gained = base, [], {}
    while True:
        make_room()
        one = play(evidence, state, candidates, full=len(state.ids) >= most)
        news = _news(one, rounds)
        best = worth_adding(one, gained, news)
        while best is not None and not _explains_laws(evidence, state, best):
            progress(f"{best.id} explains too little of what is left to be a law of its own")
            others = tuple(c for c in one.contenders if c is not best)
            one = replace(one, contenders=others)
            best = worth_adding(one, gained, news)
        rounds.append(one if best is None else led_by(one, best))
        if best is None:
            break
        progress(f"{best.id} raises the log-likelihood by {best.gain:.0f}")
        family = best.scored.effect.facts.family
        gained[family] = max(best.gain, gained.get(family, 0.0))
        state = best.state
        candidates = [e for e in candidates if e.facts.id != best.id]
    final = _backward(evidence, state)
    if final.ids:
        evidence, final = under_own_errors(evidence, final)
    return Selection(base, tuple(rounds), final.ids, final, evidence)


def under_own_errors(evidence: Evidence, state: State) -> tuple[Evidence, State]:
    """Σ with rig errors acting on the force that a model has, and the model fitted under it.

    A gain, a delay and errors of the laws go with the force of the damper and all its effects.
    Under a Σ made of the force without an effect, the delay of one test and that of the whole
    campaign differ by what the model lacked: by so little the mean delay seemed to be known from a
    single test of many harmonics, to a third of what this test's own delay leaves open.

    Laws err about the model as least squares fit it, as for a base: what a fit under Σ leaves to
    errors of the laws, Σ must not be made of.  Tests are late of the very force whose delay is
    fitted, or the two would differ again: of the fit itself, approached half way each time, since
    one that is late by too much is followed by one that is late by too little.

    Args:
        evidence: The campaign, Σ acting on the force of another model.
        state: The model, fitted under that Σ.
    """
    free = plainly_fitted(unweighted(evidence), state.coordinates, state.u)
    damper = valve_at(free.coordinates, jnp.asarray(free.u))
    evidence = evidence.beside(damper, free.gls.residual)
    rate = evidence.rate_of(state.gls.residual)
    for _ in range(TURNS):
        evidence = straightened(evidence, state.covariance, state.gls.residual)
        evidence = replace(evidence, parts=replace(evidence.parts, rate=rate))
        covariance = Covariance(evidence.parts, state.sizes)
        before, state = state, settle(evidence, state.coordinates, state.u, covariance)
        moved = state.u - before.u
        if float(moved @ state.gls.information @ moved) < STILL**2:
            break
        rate = 0.5 * (rate + evidence.rate_of(state.gls.residual))
    return evidence, state


def _news(one: Round, earlier: Sequence[Round]) -> frozenset[str]:
    """Ids of contenders that look like none of the effects that were added before them."""
    return frozenset(c.id for c in one.contenders if all(unlike(c, before) for before in earlier))


def unlike(contender: Contender, before: Round) -> bool:
    """A contender of a later round is nothing that the effect of this round missed."""
    first, state = before.contenders[0], before.before
    alike = likeness(
        contender.scored.signature, first.scored.signature, state.gls.jacobian, state.covariance
    )
    return alike < UNLIKE


def worth_adding(
    one: Round, gained: Mapping[str, float], news: Collection[str] = ()
) -> Contender | None:
    """The best contender that is a cause of its own; None if there is none.

    What it gains must not be what effects that the model has leave, acting otherwise in the two
    directions than their formulas do.

    A change of the laws that leaves them right need not be strong beside other effects; one that
    Σ hid and that leaves them wrong is an error of the laws like others.

    Args:
        one: The round.
        gained: Log-likelihood that the effects of each family gained when they were added.
        news: Ids of effects that look like none of these, of whatever family.
    """
    weak = WEAK * max(gained.values(), default=0.0)
    for contender in one.contenders:
        family = contender.scored.effect.facts.family
        again = 0.0 if contender.id in news else AGAIN * gained.get(family, 0.0)
        if family in LIKE_LAWS and contender.right:
            enough = max(contender.least, again)
        elif family in LIKE_LAWS and contender.scored.score <= contender.scored.threshold:
            continue
        else:
            enough = max(contender.least, again, weak)
        if contender.gain > enough and contender.own * contender.gain > contender.least:
            return contender
    return None


def _explains_laws(evidence: Evidence, before: State, contender: Contender) -> bool:
    """An effect that changes the laws explains most of what they are off by, in free run."""
    if contender.scored.effect.facts.family not in LIKE_LAWS:
        return True
    if contender.right:
        return True
    plain = unweighted(evidence)
    left = [
        remainder(evidence, plainly_fitted(plain, s.coordinates, s.u), contender.state.sizes)
        for s in (before, contender.state)
    ]
    return left[1].reducible <= (1.0 - OF_LAWS) * left[0].reducible


def led_by(one: Round, chosen: Contender) -> Round:
    """The round with the chosen contender first, and how far the others are from that one."""
    place = one.contenders.index(chosen)
    behind = tuple(from_first(one.before, one.contenders[place:]))
    return replace(one, contenders=behind, passed_over=one.contenders[:place])


def between_tests(effect: AbstractEffect, evidence: Evidence, *, thermal: bool) -> bool:
    """Cycle means, the order of tests and what was recorded of temperature suffice to see it.

    Args:
        effect: Any.
        evidence: The campaign.
        thermal: The valve has laws of temperature: they say what warmer oil does to every force,
            whatever was run before.
    """
    facts = effect.facts
    if facts.id in NEED_CYCLES:
        return False
    if facts.of_temperature and warmth_unseen(evidence.loops.temperature) is not None:
        return False
    if facts.id in OF_FREQUENCY and not frequency_is_varied(evidence.loops):
        return False
    if facts.id == "surface_temperature":
        warm = np.isfinite(evidence.loops.temperature).all()
        return bool(warm) and (evidence.history is not None or thermal)
    return evidence.history is not None or facts.found_from == "loops"


def _backward(evidence: Evidence, state: State) -> State:
    """Take out effects, one at a time, that are no longer worth keeping."""
    while len(state.ids) > 1:
        enough = LEAST_IF_RIGHT if laws_are_right(evidence, state) else LEAST_GAIN
        all_but_one = at_once(partial(without, evidence, state), range(len(state.ids)))
        smaller = max(all_but_one, key=lambda s: s.likelihood)
        if state.likelihood - smaller.likelihood > enough:
            break
        state = smaller
    return state


def without(evidence: Evidence, state: State, index: int) -> State:
    """The model without one of its effects, fitted again."""
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    kept = [k for k in range(len(damper.effects)) if k != index]
    coordinates = DamperCoordinates(
        state.coordinates.valve_coordinates,
        tuple(state.coordinates.prototypes[k] for k in kept),
    )
    smaller = Damper(damper.valve, tuple(damper.effects[k] for k in kept))
    start = np.array(place_of(coordinates, smaller))
    start[: coordinates.valve_coordinates.size] = state.u[: coordinates.valve_coordinates.size]
    return settle(evidence, coordinates, start, state.covariance)
