"""Simulation of motions of any shape, against loops and against Eq. 10's own limits."""

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.errors import DataError
from sysid.models.generalized import ASYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from sysid.motion.time_motion import clipped_share, point_peak_velocity, time_motion
from sysid.parameters import build

AMPLITUDE, FREQUENCY, CURRENT = 12.5e-3, 1.5, 0.2
OMEGA = 2 * np.pi * FREQUENCY


def loop(valve, points=360):
    a, f, i = (np.array([z]) for z in (AMPLITUDE, FREQUENCY, CURRENT))
    return np.asarray(simulate(valve, sine_motion(a, f, i, points=points)))[0]


def history(cycles=6, points=360):
    t = np.arange(cycles * points) / (points * FREQUENCY)
    return t, AMPLITUDE * np.sin(OMEGA * t)


@pytest.mark.parametrize("values", [LOW_SYMMETRIC, ASYMMETRIC], ids=["low", "asymmetric"])
def test_a_steady_sine_as_a_history_is_the_loop(values):
    valve = build(Generalized, values)
    t, x = history()
    force = np.asarray(simulate(valve, time_motion(t, x, current=CURRENT))).reshape(6, 360)
    expected = loop(valve)
    scale = np.abs(expected).max()
    inner = np.abs(force[1:-1] - expected)
    reversal = np.isin(np.arange(360), [0, 180])  # sgn ẍ is 0 on the loop there
    assert inner[:, ~reversal].max() < 1e-6 * scale
    assert np.abs(force - expected).max() < 0.1 * scale


@pytest.mark.parametrize(("points", "tolerance"), [(360, 0.035), (1440, 0.01)])
def test_the_causal_force_comes_near_as_sampling_gets_finer(points, tolerance):
    valve = build(Generalized, LOW_SYMMETRIC)
    t, x = history(points=points)
    force = np.asarray(simulate(valve, time_motion(t, x, current=CURRENT, causal=True)))
    expected = np.tile(loop(valve, points), 6)
    error = np.sqrt(np.mean((force - expected)[points:] ** 2)) / np.abs(expected).max()
    assert error < tolerance


def test_a_given_velocity_and_acceleration_are_used():
    t, x = history(cycles=2)
    v, a = OMEGA * AMPLITUDE * np.cos(OMEGA * t), -(OMEGA**2) * x
    motion = time_motion(t, x, velocity=v, acceleration=a, current=CURRENT)
    np.testing.assert_array_equal(motion.velocity, v)
    np.testing.assert_array_equal(motion.acceleration, a)
    np.testing.assert_allclose(motion.peak_velocity, OMEGA * AMPLITUDE, rtol=1e-12)
    by_velocity = time_motion(t, x, velocity=v, current=CURRENT)
    np.testing.assert_array_equal(by_velocity.velocity, v)
    np.testing.assert_allclose(by_velocity.acceleration, a, atol=1e-3 * OMEGA**2 * AMPLITUDE)


def test_a_millimetre_of_displacement_zero_costs_tens_of_newtons():
    """The reading of Eq. 10 warns of it; it grows with ω² (9 N RMS at 1.5 Hz, 72 N at 5 Hz)."""
    valve = build(Generalized, LOW_SYMMETRIC)
    rms = []
    for frequency in (1.5, 5.0):
        t = np.arange(6 * 360) / (360 * frequency)
        x = AMPLITUDE * np.sin(2 * np.pi * frequency * t)
        right = simulate(valve, time_motion(t, x, current=CURRENT))
        wrong = simulate(valve, time_motion(t, x + 1e-3, current=CURRENT))
        rms.append(float(jnp.sqrt(jnp.mean((wrong - right)[360:-360] ** 2))))
    np.testing.assert_allclose(rms, [9.35, 71.8], rtol=0.01)


def test_a_negative_radicand_is_clipped_and_counted():
    x, v, a = np.array([1e-2, 1e-2]), np.array([0.0, 0.1]), np.array([5.0, 0.5])
    np.testing.assert_allclose(point_peak_velocity(x, v, a), [0.0, np.sqrt(0.01 - 0.005)])
    t, y = history()
    assert clipped_share(time_motion(t, y, current=0.0)) == 0.0
    shifted = time_motion(t, y + 0.03, current=0.0)
    assert 0.3 < clipped_share(shifted) < 0.6
    assert np.isfinite(np.asarray(simulate(build(Generalized, LOW_SYMMETRIC), shifted))).all()


def test_rest_gives_no_force_in_the_symmetric_model():
    t = np.arange(100) / 100
    motion = time_motion(t, np.zeros(100), current=0.4)
    assert np.abs(np.asarray(simulate(build(Generalized, LOW_SYMMETRIC), motion))).max() < 1e-9


def test_time_that_does_not_increase_and_too_few_samples_are_refused():
    t, x = history(cycles=1)
    t[20] = t[19]
    with pytest.raises(DataError, match="time does not increase from sample 20"):
        time_motion(t, x, current=0.0)
    with pytest.raises(DataError, match="6 samples are too few"):
        time_motion(np.arange(6.0), np.zeros(6), current=0.0)
