"""What a diagnosis leaves open, as dampers: each explanation fitted to all tests.

Of a class every member takes the place of the best one and is fitted again, so that all of them
explain the tests as well as they can.  Of an effect that the base model absorbs in these tests
there is the final model with and without it, at its nominal size.  What cannot be put like that is
told with the test that the catalogue has for it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import jax.numpy as jnp
import numpy as np

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.judged import round_of
from sysid.diagnosis.ladder import CLEARLY
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.prototypes import at_size, prototypes, size_of
from sysid.diagnosis.quantities import sensible_covariance
from sysid.diagnosis.questions import Alternative, Open, Question, Told
from sysid.diagnosis.result import Cause, Invisible
from sysid.diagnosis.selection import between_tests
from sysid.diagnosis.state import State
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import choice_of, effect_kind
from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.gls import gauss_newton
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates


def left_open(best: Extended, causes: Sequence[Cause], invisible: Sequence[Invisible]) -> Open:
    """Collect what is open.

    Args:
        best: The extended base with its verdicts.
        causes: What was asserted.
        invisible: What the tests cannot show.
    """
    final = best.selection.final
    noise = float(np.median(best.base.evidence.parts.noise))
    fitted = final.sizes != NONE  # without Σ nothing says how surely a test would tell
    questions = (*_classes(best, causes), *_absorbed(best, invisible)) if fitted else ()
    return Open(questions, tuple(_told(causes, invisible, questions)), final.sizes, noise)


def _told(
    causes: Sequence[Cause], invisible: Sequence[Invisible], questions: Sequence[Question]
) -> Iterator[Told]:
    """Classes, families and invisible effects that no question is about."""
    asked = {frozenset(q.about) for q in questions}
    for cause in causes:
        if cause.separating_test and frozenset(cause.members) not in asked:
            yield Told(cause.members, cause.separating_test)
    for one in invisible:
        if frozenset((one.id,)) not in asked:
            yield Told((one.id,), one.test)


def _classes(best: Extended, causes: Sequence[Cause]) -> Iterator[Question]:
    selection = best.selection
    for cause in causes:
        kind = cause.effect.facts.id
        if len(cause.members) < 2 or kind not in selection.kept:
            continue
        if not set(cause.members) <= _sought(best):
            continue
        found = [_forms(best, kind, member) for member in cause.members]
        if all(found):
            yield Question("class", cause.members, tuple(one for forms in found for one in forms))


def _sought(best: Extended) -> set[str]:
    """Ids of effects that these tests can say something of, so that a model with them is fitted."""
    evidence, final = best.base.evidence, best.selection.final
    thermal = valve_at(final.coordinates, jnp.asarray(final.u)).valve.thermal
    known = prototypes(evidence.size, ("loops", "history"))
    return {e.facts.id for e in known if between_tests(e, evidence, thermal=thermal)}


def _forms(best: Extended, kind: str, member: str) -> list[Alternative]:
    """The final model with a member of a class instead of the best one, in each of its forms.

    A filter of two poles passes for a delay where one of a single pole does not.  Forms that the
    tests exclude are left out; nothing is left where none can be fitted.  Nor is there any where
    the model has that member besides: it would have it twice.
    """
    evidence, final = best.base.evidence, best.selection.final
    if member != kind and member in final.ids:
        return []
    place = final.ids.index(kind)
    fitted = [
        state
        for effect in prototypes(evidence.size)
        if effect.facts.id == member
        for state in _fitted(evidence, final, place, effect, _start(best, kind, effect))
    ]
    if member == kind:
        own = choice_of(final.coordinates.prototypes[place])
        fitted = [s for s in fitted if choice_of(s.coordinates.prototypes[place]) != own]
        fitted.append(final)
    cost = [_cost(final.covariance, s) for s in fitted]
    return [
        _alternative((member,), s)
        for s, c in zip(fitted, cost, strict=True)
        if c - min(cost) < 2.0 * CLEARLY
    ]


def _start(best: Extended, kind: str, effect: AbstractEffect) -> AbstractEffect:
    """An effect at its nominal shape, or where a round has it, in the form that it has there."""
    round_ = round_of(best.selection, kind)
    member = effect.facts.id
    contender = next((c for c in round_.contenders if c.id == member), None)
    if contender is not None:
        state = contender.state
        damper = valve_at(state.coordinates, jnp.asarray(state.u))
        now = damper.effects[state.ids.index(member)]
        if choice_of(now) == choice_of(effect):
            return now
        return at_size(effect, size_of(now))
    scored = next((s for s in round_.scores if s.effect.facts.id == member), None)
    if scored is None:
        return effect
    same = choice_of(scored.effect) == choice_of(effect)
    return at_size(scored.effect if same else effect, float(scored.expected))


def _fitted(
    evidence: Evidence, final: State, place: int, prototype: AbstractEffect, start: AbstractEffect
) -> Iterator[State]:
    """The final model with another effect in a place, fitted again if it can be."""
    coordinates = DamperCoordinates(
        final.coordinates.valve_coordinates, _with(final.coordinates.prototypes, place, prototype)
    )
    now = valve_at(final.coordinates, jnp.asarray(final.u))
    u = np.array(place_of(coordinates, Damper(now.valve, _with(now.effects, place, start))))
    try:
        gls = gauss_newton(lambda z: evidence.look(coordinates, z), u, final.covariance)
    except (ValueError, np.linalg.LinAlgError):
        return
    yield replace(final, coordinates=coordinates, gls=gls)


def _cost(covariance: Covariance, state: State) -> float:
    r = state.gls.residual[:, :, None]
    return float(covariance.inner(r, r)[0, 0])


def _with(
    effects: tuple[AbstractEffect, ...], place: int, new: AbstractEffect
) -> tuple[AbstractEffect, ...]:
    return (*effects[:place], new, *effects[place + 1 :])


def _alternative(ids: tuple[str, ...], state: State) -> Alternative:
    coordinates = state.coordinates
    damper = valve_at(coordinates, jnp.asarray(state.u))
    covariance = sensible_covariance(state)
    return Alternative(ids, damper, coordinates.free, coordinates.ties, covariance)


def _absorbed(best: Extended, invisible: Sequence[Invisible]) -> Iterator[Question]:
    """The final model with and without each effect that its parameters absorb in these tests.

    One that was not looked for, since all tests have one temperature, say, is not absorbed: beside
    the fitted model it would contradict the tests that there are, and any test would show it.
    """
    asked = [
        one.id
        for one in invisible
        if one.absorbed and effect_kind(one.id).facts.found_from == "loops"
    ]
    if not asked:
        return
    without = _alternative((), best.selection.final)
    nominal = prototypes(best.base.evidence.size)
    for id in asked:
        effect = next((e for e in nominal if e.facts.id == id), None)
        if effect is not None and id not in best.selection.final.ids:
            damper = without.damper.with_effect(effect)
            with_ = Alternative((id,), damper, (), (), np.zeros((0, 0)))
            yield Question("invisible", (id,), (with_, without))
