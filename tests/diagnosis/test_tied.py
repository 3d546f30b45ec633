"""Campaigns in which frequency cannot be told from speed, and the tests that would tell."""

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.selection import between_tests
from sysid.diagnosis.tied import (
    OF_SPEED,
    SLOWER,
    frequency_is_tied,
    frequency_is_varied,
    like_speed,
    one_frequency,
    untying_tests,
    untying_words,
)
from sysid.diagnosis.within_tests import Within
from sysid.effects.registry import effect_kind, make
from sysid.identification.conditions import conditions as conditions_of
from tests.data.loop_of import loops_of

PAPER = ((10e-3, 8.0), (5e-3, 4.0))
"""BS09's two excitations."""
UNTYING = ((10e-3, 2.0), (2.5e-3, 8.0))
"""The slower speed at the larger amplitude and at the higher frequency: what the rig has shown."""


def campaign_at(conditions) -> Loops:
    amplitude, frequency = np.array(conditions).T
    return loops_of(np.zeros((amplitude.size, 72)), amplitude, frequency, 0.0 * amplitude)


def test_two_excitations_or_one_amplitude_tie_frequency_to_speed():
    assert frequency_is_tied(campaign_at(PAPER))
    assert frequency_is_tied(campaign_at([(5e-3, f) for f in (0.5, 1.0, 2.0, 8.0)]))


def test_one_frequency_is_not_tied_to_anything():
    """Nothing in such tests depends on it: a loss that grows with speed is no law of frequency."""
    one = campaign_at([(a, 1.5) for a in (2e-3, 5e-3, 25e-3)])
    assert not frequency_is_varied(one)
    assert not frequency_is_tied(one)
    assert frequency_is_varied(campaign_at(PAPER))


def test_one_test_more_unties_them():
    assert not frequency_is_tied(campaign_at((*PAPER, UNTYING[0])))
    assert not frequency_is_tied(campaign_at((*PAPER, UNTYING[1])))
    assert not frequency_is_tied(campaign_at([(a, f) for a in (5e-3, 25e-3) for f in (0.5, 1.5)]))


def test_the_tests_that_would_tell_are_those_of_the_slower_speed():
    np.testing.assert_allclose(untying_tests(campaign_at(PAPER)), UNTYING, rtol=1e-9)
    words = untying_words(campaign_at(PAPER))
    assert "10 mm at 2 Hz" in words
    assert "2.5 mm at 8 Hz" in words


def test_a_test_that_was_done_is_not_asked_for():
    np.testing.assert_allclose(untying_tests(campaign_at((*PAPER, UNTYING[0]))), UNTYING[1:])
    np.testing.assert_allclose(untying_tests(campaign_at((*PAPER, UNTYING[1]))), UNTYING[:1])


def test_a_rig_that_scatters_is_asked_for_the_same_tests():
    """No two strokes and frequencies of a rig are the same; one test is not asked for twice."""
    rng = np.random.default_rng(5)
    scattered = np.array(PAPER * 18) * np.exp(rng.normal(0.0, [4e-3, 5e-4], (36, 2)))
    np.testing.assert_allclose(untying_tests(campaign_at(scattered)), UNTYING, rtol=0.02)


@pytest.mark.parametrize(
    "two",
    [
        PAPER,
        ((50e-3, 0.5), (2e-3, 5.0)),
        ((30e-3, 0.5), (10e-3, 1.0)),
        ((5e-3, 0.5), (5e-3, 1.0), (5e-3, 2.0), (5e-3, 8.0)),
        ((2e-3, 1.5), (25e-3, 1.5)),
    ],
)
def test_nothing_is_asked_that_the_rig_has_not_shown(two):
    """No amplitude beyond the largest, no frequency beyond the highest; and they untie."""
    loops = campaign_at(two)
    tests = untying_tests(loops)
    assert len(tests) in (1, 2)
    for amplitude, frequency in tests:
        assert amplitude <= loops.amplitude.max() * (1.0 + 1e-9)
        assert SLOWER * loops.frequency.min() <= frequency <= loops.frequency.max()
        speed = 2.0 * np.pi * amplitude * frequency
        assert np.isclose(loops.peak_velocity, speed).any()
    assert not frequency_is_tied(campaign_at((*two, *tests)))


def test_one_speed_and_frequency_are_halved_and_doubled():
    tests = untying_tests(campaign_at([(10e-3, 1.5)]))
    np.testing.assert_allclose(tests, [(20e-3, 0.75), (5e-3, 3.0)])


@pytest.mark.parametrize("id", OF_SPEED)
def test_speed_and_frequency_stand_for_each_other(id):
    assert id in like_speed("frequency_law")
    assert like_speed(id) == ("frequency_law",)
    assert effect_kind(id).facts.id == id
    assert like_speed("gas_spring") == ()


def one_amplitude(loops: Loops) -> np.ndarray:
    """Tests of the amplitude that has the most frequencies."""
    sizes = np.round(loops.amplitude, 4)
    most = max(np.unique(sizes), key=lambda z: np.unique(conditions_of(loops)[sizes == z]).size)
    return sizes == most


def test_what_cannot_be_told_apart_is_said_with_the_tests_that_would(evidence):
    """Where nothing was found, too: a law of frequency may be there and pass for one of speed."""
    conditions = conditions_of(evidence.loops)
    one = gather(evidence.loops.select(np.isin(conditions, conditions[:1])))
    told = {z.id: z for z in hidden(one, (), Within())}
    assert told["frequency_law"].because == one_frequency(one.loops)
    assert "frequenc" in one_frequency(one.loops)
    assert not between_tests(make(effect_kind("frequency_law")), one, thermal=False)
    assert "the same speeds at other frequencies" in told["frequency_law"].test
    tied = gather(evidence.loops.select(one_amplitude(evidence.loops)))
    untied = {z.id for z in hidden(evidence, (), Within())}
    assert "frequency_law" not in untied
    told = {z.id: z for z in hidden(tied, (), Within())}
    assert "cannot be told from a law of speed" in told["frequency_law"].because
    assert "the same speeds at other frequencies" in told["frequency_law"].test
    law = make(effect_kind("frequency_law"))
    for survives, absorbed in ((1e-3, True), (0.5, False)):
        score = Scored(law, 0.0, 9.0, survives, 0.0, 1.0, tied.measured)
        told = {z.id: z for z in hidden(tied, (score,), Within())}
        assert told["frequency_law"].absorbed == absorbed, "only then a question for a simulation"
    asserted = hidden(tied, (), Within(), ("shear_thinning",))
    assert "frequency_law" not in {z.id for z in asserted}
