"""The measuring chain."""

import numpy as np
import pytest

from sysid.rig.physical.channels import behind, low_pass

RATE = 20_000.0
TIME = np.arange(20_000) / RATE


@pytest.mark.parametrize(("frequency", "gain"), [(5.0, 1.0), (250.0, 0.5**0.5), (1000.0, 0.0624)])
def test_the_filter_has_butterworths_gain(frequency, gain):
    """1/√(1 + (f/f_c)⁴)."""
    wave = low_pass(np.sin(2 * np.pi * frequency * TIME), 250.0, RATE)[-8000:]
    assert np.sqrt(2.0 * np.mean(wave**2)) == pytest.approx(gain, rel=0.02)


def test_at_low_frequency_it_is_a_delay():
    """√2/(2π f_c), so a channel with a lower corner is late."""
    slow = low_pass(TIME, 250.0, RATE)[-1]
    assert TIME[-1] - slow == pytest.approx(np.sqrt(2.0) / (2 * np.pi * 250.0), rel=1e-3)


def test_a_constant_passes_at_once_and_a_thermocouple_lags():
    assert low_pass(np.full(5, 7.0), 250.0, RATE) == pytest.approx(np.full(5, 7.0))
    ramp = 40.0 + 2.0 * np.arange(1000) / 10.0
    assert ramp[-1] - behind(ramp, 1.5, 10.0)[-1] == pytest.approx(3.0, rel=1e-3)
