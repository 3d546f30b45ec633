"""The actuator's motion."""

import numpy as np
import pytest

from sysid.rig.excitation import Harmonic, SineRun

RUN = SineRun(
    amplitude=12.5e-3,
    frequency=1.5,
    centre=3e-3,
    harmonics=(Harmonic(2, 1.5e-3, 0.3), Harmonic(3, 3e-3, 0.8)),
    rest=0.15,
    ramp_up=1.5,
    steady=8.0,
    ramp_down=1.0,
)
TIME = np.linspace(0.0, RUN.duration, 40_001)


def test_velocity_is_the_derivative_of_displacement_in_ramps_too():
    h = 1e-6
    ahead, behind = RUN.state(TIME + h).displacement, RUN.state(TIME - h).displacement
    slope = (ahead - behind) / (2 * h)
    np.testing.assert_allclose(RUN.state(TIME).velocity, slope, rtol=0, atol=1e-6)


def test_rest_ramp_steady_ramp_rest():
    state = RUN.state(TIME)
    resting = (RUN.rest > TIME) | (RUN.duration - RUN.rest < TIME)
    assert np.all(state.velocity[resting] == 0.0)
    assert np.all(state.acceleration_sign[resting] == 0.0)
    np.testing.assert_allclose(state.displacement[resting], RUN.centre, rtol=1e-12)
    steady = RUN.steady_part(TIME)
    assert np.ptp(TIME[steady]) == pytest.approx(8 / 1.5, rel=1e-3)
    v_m = 2 * np.pi * 1.5 * 12.5e-3
    np.testing.assert_allclose(state.peak_velocity[steady], v_m, rtol=1e-12)
    assert np.all(state.peak_velocity[~steady] < v_m)
    rising = (RUN.rest < TIME) & (RUN.rest + 1.5 / 1.5 > TIME)
    assert np.all(np.diff(state.peak_velocity[rising]) > 0)


def test_peak_velocity_is_that_of_w11_eq_10_on_a_pure_sinusoid():
    pure = SineRun(12.5e-3, 1.5, 0.0, (), 0.15, 1.5, 8.0, 1.0)
    t = TIME[pure.steady_part(TIME)]
    state, omega = pure.state(t), 2 * np.pi * 1.5
    acceleration = -(omega**2) * state.displacement
    eq_10 = np.sqrt(state.velocity**2 - acceleration * state.displacement)
    np.testing.assert_allclose(state.peak_velocity, eq_10, rtol=1e-12)
    assert np.array_equal(state.acceleration_sign, np.sign(acceleration))


def test_harmonics_have_the_size_stated():
    t = RUN.rest + (RUN.ramp_up + np.arange(8 * 128) / 128) / RUN.frequency
    spectrum = np.fft.rfft(RUN.state(t).displacement) * 2 / t.size / RUN.amplitude
    assert np.abs(spectrum[[8, 16, 24]]) == pytest.approx([1.0, 1.5e-3, 3e-3], rel=1e-6)
