"""Recommended tests as an engineer would ask for them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from sysid.diagnosis.questions import Question, Told
from sysid.diagnosis.words import EFFECT_WORDS
from sysid.effects.registry import effect_kind
from sysid.planning.advice import DECISIVE, WITHOUT_LAWS, WORTH, Advice, Plan
from sysid.planning.candidates import Candidate

BEYOND: Final = 6.0
"""log₁₀ of a Bayes factor beyond which its size means nothing: no model is that right.  A diagnosis
may ask for more all the same."""
NEAR_END: Final = 0.97
"""Part of the amplitude from which on a place is the reversal."""
NEAR_CENTRE: Final = 0.1


def candidate_words(test: Candidate) -> str:
    """A test in words: its motion and current."""
    motion = f"{1e3 * test.amplitude:.3g} mm at {test.frequency:.3g} Hz"
    if test.kind == "rod_disconnected":
        return f"the rig without the damper, {motion}"
    if test.kind == "triangle":
        return f"a triangle wave of {motion}, {test.current:.3g} A"
    if test.kind == "current_step":
        return (
            f"{motion} with the current switched to {test.current:.3g} A when the rod is half way "
            "in, and off half way out"
        )
    return f"{motion}, {test.current:.3g} A"


def advice_words(advice: Advice, question: Question) -> str:
    """Why a test, and what to expect of it under each explanation."""
    told = [p.log_bayes for p in advice.pairs if p.log_bayes >= WORTH]
    groups = _alike(advice, question)
    expected = ", ".join(f"{_forces(g, advice)} if {_if(g, question)}" for g in groups)
    scatter = f"(a point scatters by {max(advice.noise, 0.1):.2g} N)"
    if not told:
        return (
            "says nothing by itself; beside the other tests it holds what could pass for the "
            f"difference that they show: {_place(advice)} expect {expected} {scatter}"
        )
    if question.kind == "invisible":
        purpose = f"would show {_named(question.about)}"
    else:
        purpose = f"tells {' from '.join(_or(g, question) for g in groups)}"
    odds = _odds(min(told), advice, question)
    return f"{purpose} ({odds}): {_place(advice)} expect {expected} {scatter}"


def open_words(plan: Plan) -> Iterator[str]:
    """What these tests do not settle, a sentence each."""
    for question in plan.better:
        yield f"These tests alone do not settle {_about(question)}."
    for question in plan.hopeless:
        if question.kind == "invisible":
            yield (
                f"No test within the limits would show {_named(question.about)} at its usual size; "
                f"{_advised(question)}."
            )
        else:
            yield (
                f"No test within the limits separates {_named(question.about)}; "
                f"{_advised(question)}."
            )
    if plan.waiting:
        waiting = " and ".join(_about(q) for q in plan.waiting)
        yield f"Not looked after by these tests: {waiting}."


def force_words(strongest: Mapping[Candidate, float]) -> Iterator[str]:
    """What proposed tests ask of the load cell where no limit of the force is known.

    Args:
        strongest: N, largest force of each test; no sentence where there are no tests.
    """
    if strongest:
        test, force = max(strongest.items(), key=lambda one: one[1])
        yield (
            f"The largest force to expect in these tests is {force:.4g} N "
            f"({candidate_words(test)}); what exceeds a `force` under [limits] is not asked for"
        )


def none_words(answer: str) -> str:
    """Where a diagnosis left no explanations to be told apart by simulated tests."""
    if answer in ("unknown", "base_inadequate"):
        return (
            f"The diagnosis ended with {answer.replace('_', ' ')!r}: it has no rival explanations, "
            "so no test can be chosen that would tell them apart."
        )
    return "The diagnosis left no explanations that a simulated test could tell apart."


def told_words(told: Sequence[Told]) -> Iterator[str]:
    """What is open besides, a sentence each with the test that would answer it."""
    for one in told:
        yield f"Not simulated here: {_named(one.about)}. {one.test}."


def _alike(advice: Advice, question: Question) -> list[list[int]]:
    """Alternatives that this test does not tell apart, together; all forms of an effect are one."""
    ids = [one.ids for one in question.alternatives]
    weak = {(ids[p.first], ids[p.second]) for p in advice.pairs if p.log_bayes < WORTH}
    groups: list[list[tuple[str, ...]]] = []
    for k in dict.fromkeys(ids):
        near = (g for g in groups if {(g[0], k), (k, g[0])} & weak)
        found = next(near, None)
        if found is None:
            groups.append([k])
        else:
            found.append(k)
    return [[k for k, one in enumerate(ids) if one in g] for g in groups]


def _forces(group: Sequence[int], advice: Advice) -> str:
    """What is expected if one of a group is right, N."""
    forces = [advice.expected[k].force for k in group]
    low, high = (f"{z:.0f}" for z in (min(forces), max(forces)))
    return f"{low} N" if low == high else f"{low} to {high} N"


def _or(group: Sequence[int], question: Question) -> str:
    return _named([i for k in group for i in question.alternatives[k].ids])


def _if(group: Sequence[int], question: Question) -> str:
    ids = [i for k in group for i in question.alternatives[k].ids]
    return f"it is {_named(ids)}" if ids else "it is not there"


def _named(ids: Sequence[str]) -> str:
    names = [EFFECT_WORDS.get(i, i) for i in dict.fromkeys(ids)]
    return " or ".join(names)


def _about(question: Question) -> str:
    if question.kind == "invisible":
        return f"whether there is {_named(question.about)}"
    return f"whether it is {_named(question.about)}"


def _advised(question: Question) -> str:
    """What the catalogue says, beyond the tests that are simulated here."""
    test = effect_kind(question.about[0]).facts.separating_test
    return f"the catalogue's advice is: {test}"


def _odds(log_bayes: float, advice: Advice, question: Question) -> str:
    alone = advice.test.kind == "rod_disconnected"
    if log_bayes >= (WITHOUT_LAWS if alone else DECISIVE[question.kind]):
        return "beyond doubt"
    if log_bayes >= BEYOND:
        return "a strong hint"
    return f"expected odds {10.0**log_bayes:.2g} to 1, a hint"


def _place(advice: Advice) -> str:
    """Where on the stroke the explanations differ most."""
    sine, cosine = np.sin(advice.phase), np.cos(advice.phase)
    if abs(sine) >= NEAR_END:
        return f"at the {'inner' if sine > 0 else 'outer'} reversal"
    way = "in" if cosine > 0 else "out"
    if abs(sine) <= NEAR_CENTRE:
        return f"at mid-stroke on the way {way}"
    return f"at {1e3 * advice.test.amplitude * sine:.2g} mm on the way {way}"
