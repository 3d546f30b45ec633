"""Which tests are recommended, and that they would settle what is asked."""

import numpy as np
import pytest

from sysid.diagnosis.questions import Open, Question
from sysid.planning.advice import DECISIVE, Advice, Pair, advise, until_settled
from sysid.planning.candidates import Candidate
from sysid.planning.limits import limits_within
from sysid.planning.words import advice_words, candidate_words, open_words
from tests.planning.asked import DONE, NOISE, SIZES, a_class, alternative

LIMITS = limits_within(DONE, stroke=0.075, velocity=0.5, current=0.4)


@pytest.fixture(scope="module")
def inertia_or_spring():
    """At 1.5 Hz a gas spring of 1 kN/m is an inertia of −11 kg."""
    mass = -1000.0 / (3 * np.pi) ** 2
    asked = a_class("gas_spring", "fluid_inertia", gas_spring=1000.0, fluid_inertia=mass)
    return asked, advise(asked, LIMITS, 40.0)


def test_spring_or_inertia_is_settled_far_from_the_frequency_that_was_tested(inertia_or_spring):
    asked, plan = inertia_or_spring
    (one,) = plan.tests
    assert plan.settled == asked.questions
    assert one.test.kind == "sine"
    assert one.test.frequency > 10.0 or one.test.frequency < 0.3
    assert one.log_bayes > 10.0


def test_what_to_expect_is_what_the_alternatives_say(inertia_or_spring):
    _, plan = inertia_or_spring
    one = plan.tests[0]
    spring, mass = (e.force for e in one.expected)
    assert one.expected[0].ids == ("gas_spring",)
    x = one.test.amplitude * np.sin(one.phase)
    a = -((2 * np.pi * one.test.frequency) ** 2) * x
    assert spring - mass == pytest.approx(1000.0 * x + 1000.0 / (3 * np.pi) ** 2 * a, rel=1e-6)


def test_the_words_say_test_reason_and_expectation(inertia_or_spring):
    asked, plan = inertia_or_spring
    one = plan.tests[0]
    told = advice_words(one, asked.questions[0])
    assert f"{1e3 * one.test.amplitude:.3g} mm at {one.test.frequency:.3g} Hz" in candidate_words(
        one.test
    )
    assert "tells a gas spring from inertia of the fluid (beyond doubt)" in told
    assert f"{one.expected[0].force:.0f} N if it is a gas spring" in told
    assert "(a point scatters by 3.8 N)" in told
    assert list(open_words(plan)) == []


def test_a_mass_of_the_fixture_is_told_from_the_fluid_s_by_taking_the_damper_out():
    plan = advise(
        a_class("fluid_inertia", "fixture_inertia", fluid_inertia=1.0, fixture_inertia=1.0),
        LIMITS,
        40.0,
    )
    assert [a.test.kind for a in plan.tests] == ["rod_disconnected"]
    assert len(plan.settled) == 1


def test_three_alternatives_take_the_tests_that_together_settle_all_pairs():
    mass = -1000.0 / (3 * np.pi) ** 2
    asked = a_class(
        "gas_spring", "fluid_inertia", "fixture_inertia",
        gas_spring=1000.0, fluid_inertia=mass, fixture_inertia=mass,
    )  # fmt: skip
    plan = advise(asked, LIMITS, 40.0)
    assert [a.test.kind for a in plan.tests] == ["sine", "rod_disconnected"]
    assert plan.settled == asked.questions
    told = advice_words(plan.tests[0], asked.questions[0])
    assert "a gas spring from inertia of the fluid or inertia of the fixture" in told


def test_where_nothing_differs_no_test_is_recommended():
    same = alternative("gas_spring")
    question = Question("class", ("gas_spring", "gas_spring"), (same, same))
    plan = advise(Open((question,), (), SIZES, NOISE), LIMITS, 40.0)
    assert plan.tests == ()
    assert plan.hopeless == (question,)
    assert "No test within the limits separates" in " ".join(open_words(plan))


def test_an_effect_that_the_base_absorbed_is_asked_for_where_it_shows():
    with_, without = alternative("gas_spring"), alternative("gas_spring", 1e-9)
    without = type(without)(
        (), without.damper, without.symbols[:-1], (), without.covariance[:-1, :-1]
    )
    question = Question("invisible", ("gas_spring",), (with_, without))
    plan = advise(Open((question,), (), SIZES, NOISE), LIMITS, 40.0)
    assert plan.settled == (question,)
    told = advice_words(plan.tests[0], question)
    assert told.startswith("would show a gas spring")
    assert "if it is not there" in told


def scored(kind, *log_bayes, frequency=1.0):
    """A test that tells pairs 01, 02, 12 apart by so much."""
    numbers = ((0, 1), (0, 2), (1, 2))
    pairs = tuple(Pair(a, b, z) for (a, b), z in zip(numbers, log_bayes, strict=True))
    return Advice(Candidate(kind, 0.01, frequency, 0.0), (), pairs, 0.0, (), 1.0)


def test_tests_are_added_until_the_least_sure_pair_is_decided():
    sure = scored("sine", 9.0, 9.0, 0.1)
    other, third = (scored("sine", 0.0, 0.0, 1.2, frequency=f) for f in (2.0, 3.0))
    assert until_settled([other, sure, third], 3) == (sure, other, third)
    assert until_settled([other, sure], 3) == (sure, other), "the same test is not asked for twice"
    assert until_settled([other, sure], 1) == (sure,)
    enough = scored("sine", 3.0, 3.0, 3.0)
    assert until_settled([other, sure, enough], 3) == (enough,)


def test_what_is_no_hint_is_no_reason_for_a_test():
    assert until_settled([scored("sine", 0.2, 0.4, 0.3)], 3) == ()
    assert until_settled([], 3) == ()


def test_a_test_that_was_chosen_counts():
    sure = scored("sine", 9.0, 9.0, 0.1)
    rest = scored("rod_disconnected", 0.0, 0.0, 5.0)
    assert until_settled([rest], 3, (sure,)) == (sure, rest)
    assert until_settled([sure], 3, (scored("sine", *(3 * [DECISIVE])),))[1:] == ()
