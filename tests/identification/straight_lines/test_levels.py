"""Which tests were meant to be alike."""

import numpy as np
import pytest

from sysid.identification.straight_lines.levels import (
    AMPLITUDE_GAP,
    FREQUENCY_GAP,
    current_levels,
    grouped,
)


def sizes(values: np.ndarray, gap: float) -> list[int]:
    return [len(group) for group in grouped(np.log(values), gap)]


def test_neighbouring_amplitudes_do_not_chain_into_one():
    """17.5, 20 and 22.5 mm are closer to one another than an actuator may miss, yet three."""
    rng = np.random.default_rng(0)
    meant = np.repeat([17.5, 20.0, 22.5], 8)
    measured = rng.permutation(meant) * (1.0 + 0.01 * rng.standard_normal(24))
    assert sizes(meant, AMPLITUDE_GAP) == [8, 8, 8]
    assert sizes(measured, AMPLITUDE_GAP) == [8, 8, 8]
    assert sizes(np.array([1.0, 1.04, 1.08, 1.12]), FREQUENCY_GAP) == [1, 1, 1, 1]


def test_scatter_of_one_amplitude_stays_one():
    """Neighbours may chain as long as all of them are one level's scatter."""
    assert sizes(10.0 * np.array([0.93, 0.97, 1.0, 1.0, 1.02, 1.06]), AMPLITUDE_GAP) == [6]


@pytest.mark.parametrize("count", [30, 3000])
def test_no_level_is_wider_than_its_gap(count):
    values = np.sort(np.random.default_rng(count).uniform(np.log(5.0), np.log(20.0), count))
    groups = grouped(values, AMPLITUDE_GAP)
    np.testing.assert_array_equal(np.sort(np.concatenate(groups)), np.arange(count))
    assert all(np.ptp(values[g]) <= AMPLITUDE_GAP for g in groups)
    starts = [values[g].min() for g in groups]
    assert starts == sorted(starts)
    assert len(groups) <= min(count, 4.0 * np.log(4.0) / AMPLITUDE_GAP), "and none is split in vain"


def test_currents_of_a_small_coil():
    current = np.repeat([0.0, 0.02, 0.04, 0.06], 3) + np.tile([3e-6, 1e-4, -1e-4], 4)
    found = current_levels(current)
    assert [len(places) for _, places in found] == [3, 3, 3, 3]
    assert [level for level, _ in found] == pytest.approx([0.0, 0.02, 0.04, 0.06], abs=2e-4)
