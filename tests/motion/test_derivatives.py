"""Velocity and acceleration from samples, against closed forms."""

import numpy as np
import pytest

from sysid.motion.derivatives import causal_derivatives, smooth_derivatives

AMPLITUDE, FREQUENCY = 12.5e-3, 1.5
OMEGA = 2 * np.pi * FREQUENCY


def sine(t):
    x = AMPLITUDE * np.sin(OMEGA * t)
    return x, OMEGA * AMPLITUDE * np.cos(OMEGA * t), -(OMEGA**2) * x


def grid(per_cycle, cycles=4.0, jitter=0.0):
    n = round(per_cycle * cycles)
    t = np.arange(n) / (per_cycle * FREQUENCY)
    return t + jitter * np.random.default_rng(1).uniform(-0.5, 0.5, n) / (per_cycle * FREQUENCY)


def rms(error, scale):
    return float(np.sqrt(np.mean(error**2)) / scale)


@pytest.mark.parametrize(
    ("per_cycle", "jitter", "velocity", "acceleration"),
    [
        (20, 0.0, 1.2e-3, 1e-2),
        (50, 0.0, 1.2e-5, 3e-4),
        (50, 0.6, 1e-4, 2e-3),
        (200, 0.0, 1e-7, 1e-5),
    ],
)
def test_clean_sine(per_cycle, jitter, velocity, acceleration):
    """Ends included; on any grid."""
    t = grid(per_cycle, jitter=jitter)
    x, v, a = sine(t)
    smooth, got_v, got_a = smooth_derivatives(t, x)
    assert rms(smooth - x, AMPLITUDE) < 2e-4
    assert rms(got_v - v, OMEGA * AMPLITUDE) < velocity
    assert rms(got_a - a, OMEGA**2 * AMPLITUDE) < acceleration


@pytest.mark.parametrize("per_cycle", [50, 200, 1000])
def test_noise_of_a_real_encoder_is_smoothed_away(per_cycle):
    """10 µm on 12.5 mm: plain differences make the acceleration useless, the spline does not."""
    t = grid(per_cycle)
    x, v, a = sine(t)
    noisy = x + 1e-5 * np.random.default_rng(0).standard_normal(t.size)
    _, got_v, got_a = smooth_derivatives(t, noisy)
    inner = slice(per_cycle // 4, -per_cycle // 4)
    assert rms((got_v - v)[inner], OMEGA * AMPLITUDE) < 2e-3
    assert rms((got_a - a)[inner], OMEGA**2 * AMPLITUDE) < 1e-2
    assert rms(got_v - v, OMEGA * AMPLITUDE) < 1e-2
    assert rms(got_a - a, OMEGA**2 * AMPLITUDE) < 8e-2
    assert np.mean(np.sign(got_a) != np.sign(a)) < 0.04


@pytest.mark.parametrize("pause", [1.0, 60.0, 600.0, 1e5])
def test_a_pause_spoils_the_samples_beside_it_only(pause):
    """Two recordings in one file: as well smoothed as each of them."""
    t = grid(400, cycles=6.0)
    x, v, a = sine(t)
    noisy = x + 1e-6 * np.random.default_rng(0).standard_normal(t.size)
    half = t.size // 2
    stamps = t + pause * (np.arange(t.size) >= half)
    _, got_v, got_a = smooth_derivatives(stamps, noisy)
    for part in (slice(100, half - 100), slice(half + 100, -100)):
        assert rms((got_v - v)[part], OMEGA * AMPLITUDE) < 1e-3
        assert rms((got_a - a)[part], OMEGA**2 * AMPLITUDE) < 1e-2


@pytest.mark.parametrize("apart", [1e-8, 2e-7, 2e-6, 5e-5])
def test_two_stamps_next_to_each_other_spoil_nothing(apart):
    t = grid(400)
    t[[300, 900]] = t[[301, 901]] - apart
    x, v, a = sine(t)
    noisy = x + 1e-6 * np.random.default_rng(0).standard_normal(t.size)
    smooth, got_v, got_a = smooth_derivatives(t, noisy)
    inner = slice(100, -100)
    assert smooth.shape == t.shape
    assert rms((smooth - x)[inner], AMPLITUDE) < 5e-5
    assert rms((got_v - v)[inner], OMEGA * AMPLITUDE) < 1e-3
    assert rms((got_a - a)[inner], OMEGA**2 * AMPLITUDE) < 1e-2


def test_units_of_time_do_not_matter():
    t = grid(100)
    x = sine(t)[0] + 1e-5 * np.random.default_rng(0).standard_normal(t.size)
    _, v, a = smooth_derivatives(t, x)
    _, v_slow, a_slow = smooth_derivatives(1e4 * t + 7.0, x)
    np.testing.assert_allclose(1e4 * v_slow, v, rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(1e8 * a_slow, a, rtol=1e-4, atol=1e-4)


def test_rest_stays_at_rest():
    _, v, a = smooth_derivatives(np.arange(50.0), np.full(50, 0.03))
    assert np.abs(v).max() < 1e-15
    assert np.abs(a).max() < 1e-15


@pytest.mark.parametrize("jitter", [0.0, 0.8])
def test_causal_rule_is_exact_on_a_parabola_and_knows_no_future(jitter):
    t = grid(50, jitter=jitter)
    first, second = causal_derivatives(t, 3.0 - 2.0 * t + 5.0 * t**2)
    np.testing.assert_allclose(first[2:], -2.0 + 10.0 * t[2:], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(second[2:], 10.0, rtol=1e-7)
    cut_first, cut_second = causal_derivatives(t[:30], 3.0 - 2.0 * t[:30] + 5.0 * t[:30] ** 2)
    np.testing.assert_array_equal(cut_first, first[:30])
    np.testing.assert_array_equal(cut_second, second[:30])


def test_causal_rule_is_the_stated_one():
    h, x = 0.01, np.array([1.0, 1.2, 1.1, 0.7])
    first, second = causal_derivatives(h * np.arange(4), x)
    np.testing.assert_allclose(
        first,
        [0.0, 0.2 / h, (3 * 1.1 - 4 * 1.2 + 1.0) / (2 * h), (3 * 0.7 - 4 * 1.1 + 1.2) / (2 * h)],
    )
    np.testing.assert_allclose(second, [0.0, 0.0, -0.3 / h**2, -0.3 / h**2])


def test_causal_acceleration_is_late_by_one_sample():
    t = grid(400)
    _, second = causal_derivatives(t, sine(t)[0])
    late = sine(t - t[1])[2]
    assert rms((second - late)[2:], OMEGA**2 * AMPLITUDE) < 1e-4
    assert rms((second - sine(t)[2])[2:], OMEGA**2 * AMPLITUDE) > 5e-3
