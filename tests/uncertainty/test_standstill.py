"""What a force is at standstill, where it runs smoothly and where it jumps."""

import numpy as np
import pytest

from sysid.uncertainty.standstill import standstills


def cycle(points: int, shift: float = 0.0) -> np.ndarray:
    """Phases of a cycle whose samples lie some of a step after those of 0."""
    return 2.0 * np.pi * (np.arange(points) + shift) / points


def read(force: np.ndarray, velocity: np.ndarray, *, falling: bool, periodic: bool = True) -> float:
    found = standstills(velocity[None], periodic=periodic, falling=falling)
    return float(found.mean(force[None, None])[0, 0])


@pytest.mark.parametrize("shift", [0.0, 1e-9, 0.1, 0.24, 0.26, 0.5, 0.74, 0.9, 1.0 - 1e-9])
@pytest.mark.parametrize("falling", [True, False])
def test_a_smooth_force_is_read_as_it_is(shift, falling):
    phase = cycle(72, shift)
    force = 50.0 * np.sin(phase) + 20.0 * np.sin(3.0 * phase + 0.3) + 7.0
    at = np.pi / 2.0 if falling else -np.pi / 2.0
    expected = 50.0 * np.sin(at) + 20.0 * np.sin(3.0 * at + 0.3) + 7.0
    assert read(force, np.cos(phase), falling=falling) == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_jump_at_standstill_is_read_at_its_middle_whichever_side_rounding_took(side):
    """A sample that rounding put before the standstill or after it must not decide."""
    phase = cycle(360)
    velocity = np.cos(phase)
    force = 100.0 * np.sin(phase) + np.where(velocity > 0.0, 3.0, -3.0)
    force[90] = 100.0 + 3.0 * side
    assert read(force, velocity, falling=True) == pytest.approx(100.0, abs=1e-4)


def test_a_motion_that_is_held_at_its_end_is_read_where_it_stops():
    velocity = np.array([1.0, 1.0, 0.5, 0.0, 0.0, 0.0, -0.5, -1.0, -1.0])
    force = np.array([9.0, 9.0, 8.0, 7.0, 6.0, 6.0, 5.0, 4.0, 4.0])
    assert read(force, velocity, falling=True, periodic=False) == 7.0


def test_a_turn_at_the_end_of_a_record_is_read_along_a_line():
    velocity = np.array([0.5, -0.5, -1.0, -1.0])
    force = np.array([4.0, 2.0, 0.0, 0.0])
    assert read(force, velocity, falling=True, periodic=False) == 3.0
    assert np.isnan(read(force, velocity, falling=False, periodic=False))


def test_the_last_sample_of_a_cycle_is_followed_by_its_first():
    phase = cycle(72) + np.pi / 2.0 + 0.01
    force = 30.0 * np.sin(phase)
    assert read(force, np.cos(phase), falling=True) == pytest.approx(30.0, abs=1e-3)


def test_turns_of_several_tests_are_read_each_from_its_own_force():
    phase = np.stack([cycle(144), 2.0 * cycle(144)])
    force = np.stack([10.0 * np.sin(phase[0]), 20.0 * np.sin(phase[1])])
    found = standstills(np.cos(phase), periodic=True, falling=True)
    both = found.mean(np.stack([force, 2.0 * force]))
    assert both == pytest.approx(np.array([[10.0, 20.0], [20.0, 40.0]]), abs=1e-3)
