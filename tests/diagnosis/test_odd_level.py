"""Which setting a model errs at, where one stands out."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis.odd_level import odd_level
from tests.diagnosis.test_lack_of_fit import campaign


@pytest.fixture(scope="module")
def loops() -> Loops:
    return campaign(lambda x, v, a, A, f, i: (60.0 + 500.0 * i) * np.tanh(v / 0.002) + 500.0 * v)


def _wrong_by(loops: Loops, share: np.ndarray) -> np.ndarray:
    """Simulated forces that are wrong by a share of the peak in each test."""
    peak = np.abs(loops.force).max(axis=1)
    return loops.force + (share * peak)[:, None]


def test_current_whose_error_is_larger_than_at_all_others_is_told(loops):
    share = np.where(loops.current < 0.01, 0.15, 0.02)
    found = odd_level(loops, _wrong_by(loops, share), loops.force)
    assert found is not None
    assert found.setting == "0 A"
    assert found.there == pytest.approx(0.15)
    assert found.elsewhere == pytest.approx(0.02)
    assert found.words == (
        "Relative to the peak force it is worst at 0 A: 15 % there, "
        "at other currents at most 2.0 %."
    )


def test_what_a_supply_leaves_at_zero_is_called_zero(loops):
    measured = replace(loops, current=loops.current + 8e-6)
    share = np.where(loops.current < 0.01, 0.15, 0.02)
    found = odd_level(measured, _wrong_by(loops, share), loops.force)
    assert found is not None
    assert found.setting == "0 A"


def test_amplitude_that_stands_out_is_told_in_millimetres(loops):
    largest = loops.amplitude > 0.95 * loops.amplitude.max()
    found = odd_level(loops, _wrong_by(loops, np.where(largest, 0.1, 0.01)), loops.force)
    assert found is not None
    assert found.others == "amplitudes"
    assert found.setting.endswith(" mm")


def test_current_at_which_the_error_is_far_smaller_is_told(loops):
    share = np.where(loops.current < 0.01, 0.009, 0.16 + 0.1 * loops.current)
    found = odd_level(loops, _wrong_by(loops, share), loops.force)
    assert found is not None
    assert found.words == (
        "Relative to the peak force it is far smaller at 0 A: 0.90 % there, "
        "at other currents 18 % and more."
    )


@pytest.mark.parametrize("share", [1.9, 1.0, 0.3])
def test_what_does_not_stand_out_is_not_told(loops, share):
    of_each = np.where(loops.current < 0.01, 0.02 * share, 0.02)
    assert odd_level(loops, _wrong_by(loops, of_each), loops.force) is None


def test_error_of_one_test_is_no_setting_s(loops):
    share = np.full(len(loops.ids), 0.02)
    share[0] = 0.5
    found = odd_level(loops, _wrong_by(loops, share), loops.force)
    assert found is None or found.there < 0.5
