"""Which tests are recommended, and that they would settle what is asked."""

from dataclasses import replace

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import minimize

from sysid.diagnosis.ladder import CLEARLY, SHORT
from sysid.diagnosis.questions import Alternative, Open, Question
from sysid.effects.registry import effect_kind, make
from sysid.models.damper import Damper
from sysid.planning.advice import (
    DECISIVE,
    PER_LOG10,
    WORTH,
    Advice,
    Pair,
    Scored,
    advise,
    surely,
    until_settled,
)
from sysid.planning.candidates import Candidate
from sysid.planning.discrimination import Apart, predict, weigh
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
    other = replace(same, ids=("gas_polytropic",))
    question = Question("class", ("gas_spring", "gas_polytropic"), (same, other))
    plan = advise(Open((question,), (), SIZES, NOISE), LIMITS, 40.0)
    assert plan.tests == ()
    assert plan.hopeless == (question,)
    assert "No test within the limits separates" in " ".join(open_words(plan))


@pytest.mark.parametrize("most", [2.0, 400.0, 1000.0])
def test_no_test_is_recommended_that_rig_and_damper_would_not_bear(most):
    """Whichever explanation is right."""
    asked = a_class("gas_spring", "fluid_inertia")
    within = advise(asked, replace(LIMITS, force=most), 40.0).tests
    (question,) = asked.questions
    for one in within:
        for explanation in question.alternatives:
            force = predict(explanation, [one.test], 40.0).force
            assert np.abs(force).max() <= most
    assert bool(within) == (most > 2.0), "any motion needs more than that"


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
    apart = tuple(
        (Apart(np.asarray(PER_LOG10 * z), np.zeros(0), np.zeros((0, 0))),) for z in log_bayes
    )
    return Scored(Advice(Candidate(kind, 0.01, frequency, 0.0), (), pairs, 0.0, (), 1.0), apart)


def test_tests_are_added_until_the_least_sure_pair_is_decided():
    sure = scored("sine", 9.0, 9.0, 0.1)
    other, third = (scored("sine", 0.0, 0.0, 1.2, frequency=f) for f in (2.0, 3.0))
    assert until_settled([other, sure, third], 2.0, 3) == (sure, other, third)
    assert until_settled([other, sure], 2.0, 3) == (sure, other), (
        "the same test is not asked for twice"
    )
    assert until_settled([other, sure], 2.0, 1) == (sure,)
    enough = scored("sine", 3.0, 3.0, 3.0)
    assert until_settled([other, sure, enough], 2.0, 3) == (enough,)


def test_a_test_that_says_the_same_again_says_little():
    """One parameter of the rival takes both differences away, as far as old tests leave it open."""
    first, second = (
        replace(
            scored("sine", *3 * (40.0 / PER_LOG10,), frequency=f),
            apart=3 * ((Apart(np.asarray(400.0), np.array([60.0]), np.array([[9.0]])),),),
        )
        for f in (1.0, 2.0)
    )
    (alone,) = {float(one.apart[0][0].distance()) for one in (first, second)}
    both = first.apart[0][0].beside(second.apart[0][0]).distance()
    least = minimize(lambda z: 2.0 * (20.0 - 3.0 * z) ** 2 + z * z, 0.0).fun
    assert both == pytest.approx(least, rel=1e-6)
    assert alone == pytest.approx(40.0)
    assert both < 1.1 * alone
    other = scored("sine", 2.0, 2.0, 2.0, frequency=3.0)
    assert until_settled([first, second, other], 20.0, 2) == (first, other)


def test_what_is_no_hint_is_no_reason_for_a_test():
    assert until_settled([scored("sine", 0.2, 0.4, 0.3)], 2.0, 3) == ()
    assert until_settled([], 2.0, 3) == ()


def test_a_test_that_was_chosen_counts():
    sure = scored("sine", 9.0, 9.0, 0.1)
    rest = scored("rod_disconnected", 0.0, 0.0, 5.0)
    assert until_settled([rest], 2.0, 3, (sure,)) == (sure, rest)
    assert until_settled([sure], 2.0, 3, (scored("sine", 2.0, 2.0, 2.0),))[1:] == ()


def test_what_settles_a_class_settles_it_in_the_diagnosis_nine_times_in_ten():
    """A log-likelihood ratio of expectation m scatters by √(2m)."""
    mean = DECISIVE["class"] * PER_LOG10 / 2.0
    drawn = mean + np.sqrt(2.0 * mean) * np.random.default_rng(0).normal(size=100_000)
    assert np.mean(drawn >= CLEARLY) == pytest.approx(0.9, abs=0.005)
    assert surely(0.0) > 0.0
    assert DECISIVE["invisible"] < DECISIVE["class"]


def friction(travel: float) -> Open:
    """Plain friction, or one that builds up over so many metres: 20 N both."""
    plain = alternative("seal_friction", 20.0)
    kind = effect_kind("presliding_friction")
    effect = eqx.tree_at(
        lambda e: (e.F_ps, e.sigma_0), make(kind), (jnp.asarray(20.0), jnp.asarray(20.0 / travel))
    )
    symbols = (*plain.symbols[:-1], "presliding_friction.F_ps", "presliding_friction.sigma_0")
    sd = [*np.sqrt(np.diagonal(plain.covariance))[:-1], 2.0, 0.1 * 20.0 / travel]
    built = Alternative(
        ("presliding_friction",), Damper(plain.damper.valve, (effect,)), symbols, (),
        np.diag(np.square(sd)),
    )  # fmt: skip
    question = Question("class", ("presliding_friction", "seal_friction"), (built, plain))
    return Open((question,), (), SIZES, NOISE)


def test_friction_that_builds_up_over_microns_is_not_looked_for_in_strokes_of_millimetres():
    """No diagnosis would name it there: `limits_of`."""
    large = replace(LIMITS, amplitude=(1e-3, 75e-3))
    assert advise(friction(2e-5), large, 40.0).tests == ()
    for travel, limits in ((2e-5, LIMITS), (4e-4, large)):
        tests = advise(friction(travel), limits, 40.0).tests
        assert tests != ()
        assert all(a.test.amplitude <= travel / SHORT for a in tests)


def test_a_place_is_kept_for_a_pair_of_which_sines_say_nothing():
    """Each of three sines says more of spring or inertia; only the rig alone splits the masses."""
    mass = -1000.0 / (3 * np.pi) ** 2
    weak = a_class(
        "gas_spring", "fluid_inertia", "fixture_inertia",
        gas_spring=50.0, fluid_inertia=0.05 * mass, fixture_inertia=0.05 * mass,
    )  # fmt: skip
    near = replace(LIMITS, frequency=(1.0, 4.0), velocity=0.2, amplitude=(1e-3, 25e-3))
    kinds = [a.test.kind for a in advise(weak, near, 40.0).tests]
    assert kinds == ["sine", "sine", "rod_disconnected"]


def test_a_weak_run_without_the_damper_is_worth_saying_or_is_not_asked_for():
    """Less is enough to settle a pair there, but a test must say as much as any to be run."""
    slow = replace(LIMITS, frequency=(1.0, 4.0), velocity=0.2)
    for kilograms in (0.3, 0.1, 0.05):
        asked = a_class(
            "fluid_inertia", "fixture_inertia",
            fluid_inertia=kilograms, fixture_inertia=kilograms,
        )  # fmt: skip
        for one in advise(asked, slow, 40.0).tests:
            assert one.log_bayes >= WORTH
            assert advice_words(one, asked.questions[0])


def test_neighbouring_tests_settle_only_what_they_settle_together():
    """A tenth of the spring and the mass above, at most 4 Hz."""
    mass = -100.0 / (3 * np.pi) ** 2
    asked = a_class("gas_spring", "fluid_inertia", gas_spring=100.0, fluid_inertia=mass)
    near = replace(LIMITS, frequency=(1.0, 4.0))
    plan = advise(asked, near, 40.0)
    (question,) = asked.questions
    every = [a.test for a in plan.tests if a.test.kind == "sine"]
    assert len(every) == len(plan.tests) > 1
    joined = []
    for right, other in (question.alternatives, question.alternatives[::-1]):
        first, second = (predict(one, every, 40.0) for one in (right, other))
        frequency = np.array([t.frequency for t in every])
        told = weigh(first, second, other.covariance, SIZES, NOISE, frequency)
        whole, shared, known = told.whole.sum(), told.shared.sum(axis=0), told.known.sum(axis=0)
        joined.append(float(Apart(whole, shared, known).distance()) / PER_LOG10)
    assert plan.settled == (question,)
    assert min(joined) >= DECISIVE["class"]


def test_a_test_that_helps_with_two_questions_is_counted_once():
    with_ = [alternative(z) for z in ("gas_spring", "fluid_inertia", "seal_friction")]
    without = alternative("gas_spring", 1e-9)
    none = type(without)((), without.damper, without.symbols[:-1], (), without.covariance[:-1, :-1])
    questions = tuple(Question("invisible", one.ids, (one, none)) for one in with_)
    plan = advise(Open(questions, (), SIZES, NOISE), LIMITS, 40.0, most=2)
    assert len({a.test for a in plan.tests}) <= 2
    assert len({(a.test, a.about) for a in plan.tests}) == len(plan.tests)
    assert len(plan.settled) == 3
    assert plan.waiting == ()


def test_a_test_that_speaks_only_beside_others_has_words_of_its_own(inertia_or_spring):
    """It was taken for what it adds to those before: there is no least sure pair to tell of."""
    asked, plan = inertia_or_spring
    one = plan.tests[0]
    mute = replace(one, pairs=tuple(replace(p, log_bayes=0.01) for p in one.pairs))
    told = advice_words(mute, asked.questions[0])
    assert told.startswith("says nothing by itself; beside the other tests")
    assert "N if it is a gas spring or inertia of the fluid" in told


@pytest.mark.parametrize("kind", ["sine", "triangle", "current_step"])
def test_a_current_is_asked_for_as_it_is_meant(kind):
    assert "1.75 A" in candidate_words(Candidate(kind, 0.01, 1.0, 1.75))


def test_assumed_limits_are_told_as_they_are():
    done = replace(DONE, current=(0.0, 1.25), speed=0.375, force=612.34)
    told = " ".join(limits_within(done).assumed)
    assert "1.25 A, as tested" in told
    assert "0.375 m/s, as tested" in told
    assert "none is known (the largest measured is 612.3 N)" in told
