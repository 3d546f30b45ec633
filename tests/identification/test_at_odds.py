"""A test that all others contradict is found, told by its slip, and nobody else is."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.identification.at_odds import AtOdds, at_odds
from sysid.identification.fit import fit_loops
from sysid.identification.problem import Weights
from sysid.models.generalized import LOW_SYMMETRIC
from tests.identification.campaigns import FIVE_CURRENTS, LOW_DESIGN, virtual_loops

AMONG = "12.5mm_1.5Hz_0.2A"
CORNER = "12.5mm_5Hz_0.4A"


def sound(seed=0):
    """Twenty loops whose load cell scatters by 0.6 % from test to test."""
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.01, seed=seed)
    scatter = 1.0 + 0.006 * np.random.default_rng(seed).standard_normal(len(loops.ids))
    return replace(loops, force=scatter[:, None] * loops.force)


def spoilt(loops, name, change):
    """One loop's force changed."""
    force = loops.force.copy()
    force[loops.ids.index(name)] = change(force[loops.ids.index(name)])
    return replace(loops, force=force)


def with_current(loops, name, current):
    currents = loops.current.copy()
    currents[loops.ids.index(name)] = current
    return replace(loops, current=currents)


def found_in(loops, weights: Weights = "peak") -> AtOdds | None:
    return at_odds(fit_loops(loops, variant="symmetric", weights=weights), loops)


@pytest.mark.parametrize("seed", range(6))
def test_sound_tests_agree(seed):
    assert found_in(sound(seed)) is None


@pytest.mark.parametrize("weights", ["paper", "peak", "noise"])
@pytest.mark.parametrize("name", [AMONG, CORNER, "12.5mm_0.5Hz_0A"])
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda f: 0.5 * f, "times what they tell"),
        (lambda f: 1.25 * f, "times what they tell"),
        (lambda f: f + 0.5 * np.abs(f).max(), "N were added to its force"),
        (lambda f: np.roll(f, 36), "ms late"),
        (lambda f: np.roll(f, -36), "ms early"),
    ],
)
def test_a_slip_is_found_and_told(change, words, name, weights):
    found = found_in(spoilt(sound(), name, change), weights=weights)
    assert found is not None
    assert found.ids == (name,)
    assert words in found.tests[0].looks[0]
    assert found.others == 19
    assert found.largest < 0.02 < 0.1 < found.tests[0].missed
    assert name in found.words[0]


@pytest.mark.parametrize("gain", [0.5, 0.8, 1.25, 3.0])
def test_a_gain_is_told_in_size(gain):
    found = found_in(spoilt(sound(), AMONG, lambda f: gain * f))
    assert found is not None
    told = float(found.tests[0].looks[0].split("force were ")[1].split(" times")[0])
    assert told == pytest.approx(gain, rel=0.03)


def test_a_delay_is_told_in_time():
    found = found_in(spoilt(sound(), AMONG, lambda f: np.roll(f, 36)))
    assert found is not None
    late = float(found.tests[0].looks[0].split("force came ")[1].split(" ms")[0])
    assert late == pytest.approx(1e3 * 0.1 / 1.5, rel=0.03)


def test_the_current_that_was_there_is_told():
    found = found_in(with_current(sound(), "12.5mm_1.5Hz_0.1A", 0.4))
    assert found is not None
    assert found.ids == ("12.5mm_1.5Hz_0.1A",)
    assert "its current were 0.1 A instead of 0.4 A" in found.tests[0].looks[0]


def test_what_no_single_slip_explains_is_told_as_that():
    random = np.random.default_rng(3)
    found = found_in(spoilt(sound(), AMONG, lambda f: f + 0.5 * f.max() * random.normal(size=360)))
    assert found is not None
    assert found.tests[0].looks == ()
    assert found.words[0].endswith("at most.")


def test_two_slips_at_once():
    both = spoilt(sound(), AMONG, lambda f: 0.5 * f)
    both = with_current(both, "12.5mm_5Hz_0.1A", 0.3)
    found = found_in(both)
    assert found is not None
    assert set(found.ids) == {AMONG, "12.5mm_5Hz_0.1A"}
    assert all("without the 2 that are at odds" in words for words in found.words)


def test_more_than_a_few_are_a_pattern():
    """All tests at one current, half of the force: that is what the damper does there."""
    loops = sound()
    for name in [name for name in loops.ids if name.endswith("0.2A")]:
        loops = spoilt(loops, name, lambda f: 0.5 * f)
    assert found_in(loops) is None


def test_beyond_the_others_it_may_be_the_model_that_fails():
    """The only test of its speed: nothing says that the model holds there."""
    loops = sound()
    slow = [k for k, f in enumerate(loops.frequency) if f < 3.0]
    only = loops.select(np.array([*slow, loops.ids.index("12.5mm_5Hz_0.2A")]))
    assert found_in(spoilt(only, "12.5mm_5Hz_0.2A", lambda f: 0.5 * f)) is None


def test_few_tests_contradict_nobody():
    loops = sound().select(np.arange(7))
    assert found_in(spoilt(loops, loops.ids[3], lambda f: 0.5 * f)) is None


def test_noise_alone_makes_nobody_odd():
    """A faint test among loud ones errs by its noise, which the others do not contradict."""
    loops = sound()
    random = np.random.default_rng(5)
    k = loops.ids.index("12.5mm_0.5Hz_0A")
    size = 0.4 * np.abs(loops.force[k]).max()
    cycles = size * random.standard_normal((4, 360))
    force = loops.force.copy()
    force[k] += cycles.mean(axis=0)
    noise = loops.noise_floor.copy()
    noise[k] = float(np.sqrt(np.mean(cycles.std(axis=0, ddof=1) ** 2)))
    assert found_in(replace(loops, force=force, noise_floor=noise)) is None
