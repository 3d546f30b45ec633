"""Tests that could be run: within limits, and the motion that they say."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.planning.candidates import (
    KINDS,
    Candidate,
    batches,
    candidates,
    motion_of,
    round_numbers,
    second_cycle,
)
from sysid.planning.limits import limits_within
from tests.planning.asked import DONE


def test_all_are_within_the_limits():
    limits = limits_within(DONE, stroke=0.05, velocity=0.3, current=0.4)
    every = candidates(limits)
    assert {t.kind for t in every} == set(KINDS)
    assert max(t.amplitude for t in every) == 0.05
    assert max(t.speed for t in every) <= 0.3
    assert max(t.frequency for t in every) <= 20.0
    assert {t.current for t in every} <= set(limits.current)
    assert {t.current for t in every if t.kind == "rod_disconnected"} == {0.0}
    for kind in KINDS:
        fast = sorted((t for t in every if t.kind == kind), key=lambda t: t.speed)[-12:]
        motion = motion_of(fast, 40.0)
        speed = np.abs(motion.velocity).max(axis=1)
        assert 0.25 < speed.max() <= 0.3 * (1 + 1e-9)
        np.testing.assert_allclose(speed, [t.speed for t in fast], rtol=1e-4)
        assert np.all(np.abs(motion.displacement).max(axis=1) <= 0.05 * (1 + 1e-9))


def test_what_the_manifest_does_not_say_is_taken_from_the_tests_and_told():
    limits = limits_within(DONE)
    assert limits.amplitude[1] == DONE.displacement
    assert limits.velocity == DONE.speed
    assert limits.current == DONE.current
    told = " ".join(limits.assumed)
    for words in (
        f"{2e3 * DONE.displacement:g} mm from end to end",
        "0.24 m/s",
        "0.4 A",
        "at most 20 Hz",
        "from 0.1 Hz",
        f"{100.0 * DONE.amplitude[0]:.3g} mm on",
        "no limit of the force, as none is known",
    ):
        assert words in told
    known = limits_within(DONE, stroke=1.0, velocity=1.0, current=1.0, frequency=5.0, force=1e3)
    (least,) = known.assumed  # the manifest has no word for them
    assert "from 0.1 Hz" in least
    slow = limits_within(replace(DONE, frequency=(0.05, 2.0)))
    assert slow.frequency[0] == 0.05
    assert "from 0.05 Hz" in slow.assumed[-1]
    assert known.frequency == (0.1, 5.0)
    assert known.current == (0.0, 0.2, 0.4, 1.0)


def test_no_current_beyond_the_limit():
    assert limits_within(DONE, current=0.3).current == (0.0, 0.2, 0.3)


def test_numbers_are_round_and_the_limit_is_among_them():
    assert round_numbers(0.8, 17.0) == [1.0, 1.5, 2.0, 3.0, 5.0, 7.5, 10.0, 15.0, 17.0]


@pytest.mark.parametrize(
    ("limit", "largest"), [(52.555, 52.5), (12.36, 12.3), (20.0, 20.0), (0.1, 0.1), (99.96, 99.9)]
)
def test_a_limit_is_never_exceeded_by_rounding(limit, largest):
    assert max(round_numbers(0.05, limit)) == largest


def test_a_triangle_has_constant_speed_but_for_its_corners():
    motion = motion_of([Candidate("triangle", 0.01, 2.0, 0.1)], 40.0)
    speed = np.abs(np.asarray(second_cycle(motion, motion.velocity))[0])
    assert np.median(speed) == pytest.approx(4 * 0.01 * 2.0, rel=0.1)
    assert np.mean(np.abs(speed / 0.08 - 1) < 0.2) > 0.8
    assert speed.max() < 1.15 * 0.08
    place = np.asarray(motion.displacement)[0]
    np.testing.assert_allclose(place[:360], place[360:], atol=1e-12)
    assert np.abs(place).max() == pytest.approx(0.01, rel=1e-6)


def test_a_current_step_comes_on_the_way_in_and_goes_on_the_way_out():
    motion = motion_of([Candidate("current_step", 0.01, 0.5, 0.3)], 40.0)
    current, x = np.asarray(motion.current)[0], np.asarray(motion.displacement)[0]
    assert set(np.unique(current)) == {0.0, 0.3}
    np.testing.assert_array_equal(current > 0, x > 0.005)


def test_batches_are_full_and_of_one_kind():
    limits = limits_within(replace(DONE, current=(0.0, 0.4)))
    every = candidates(limits, ("sine", "rod_disconnected"))
    parts = list(batches(every, 16))
    assert {len(p) for p in parts} == {16}
    assert all(len({t.kind for t in p}) == 1 for p in parts)
    assert [t for p in parts for t in dict.fromkeys(p)] == list(every)


def test_a_further_test_comes_last_and_its_current_is_raised():
    """Else drift and a magnetic loop would do nothing in the tests that are to show them."""
    every = candidates(limits_within(DONE))
    for kind in KINDS:
        motion = motion_of([t for t in every if t.kind == kind][:2], 40.0)
        assert motion.run_share is not None
        assert motion.ramp is not None
        np.testing.assert_array_equal(motion.run_share, np.ones((2, 1)))
        currents = [t.current for t in every if t.kind == kind][:2]
        if kind != "current_step":
            np.testing.assert_array_equal(np.asarray(motion.ramp)[:, 0], np.sign(currents))
            continue
        on = np.asarray(motion.current) != 0.0
        np.testing.assert_array_equal(motion.ramp, np.where(on, 1.0, -1.0))
