"""Delay and filters: closed forms on cycles, causal elsewhere."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.channel.force_delay import ForceDelay
from sysid.effects.channel.force_filter import ForceFilter
from sysid.effects.drive.coil_lag import CoilLag
from sysid.motion.motion import sine_motion
from sysid.motion.time_motion import time_motion

F, TAU = 5.0, 3e-3
LOOP = sine_motion(0.01, F, 0.2, points=72)
PHASE = 2 * np.pi * np.arange(72) / 72


def test_delay_of_harmonics_is_exact():
    signal = np.sin(PHASE) + 0.3 * np.cos(7 * PHASE)
    late = PHASE - 2 * np.pi * F * TAU
    expected = np.sin(late) + 0.3 * np.cos(7 * late)
    got = ForceDelay(TAU).recorded(jnp.asarray(signal[None]), LOOP)
    np.testing.assert_allclose(got[0], expected, atol=1e-12)


def test_filter_of_a_harmonic_is_exact():
    got = ForceFilter(TAU).recorded(jnp.asarray(np.cos(3 * PHASE)[None]), LOOP)
    response = 1 / (1 + 1j * 3 * 2 * np.pi * F * TAU)
    np.testing.assert_allclose(got[0], (response * np.exp(3j * PHASE)).real, atol=1e-12)


def record(n: int = 400):
    t = np.sort(np.random.default_rng(3).uniform(0.0, 0.4, n))
    return t, time_motion(t, 0.01 * np.sin(30 * t), current=0.2)


def test_delay_of_a_record_reads_the_past():
    t, motion = record()
    got = np.asarray(ForceDelay(0.01).recorded(jnp.asarray(2.0 + 5.0 * t), motion))
    after = t > t[0] + 0.01
    np.testing.assert_allclose(got[after], 2.0 + 5.0 * (t[after] - 0.01), rtol=1e-10)
    np.testing.assert_allclose(got[~after], 2.0 + 5.0 * t[0])


def test_filter_of_a_ramp_and_a_step_on_an_uneven_grid():
    """Behind a first-order lag a ramp t − t_0 becomes (t − t_0) − τ (1 − e^{−(t−t_0)/τ})."""
    t, motion = record()
    since = t - t[0]
    got = ForceFilter(0.02).recorded(jnp.asarray(since), motion)
    np.testing.assert_allclose(got, since - 0.02 * -np.expm1(-since / 0.02), atol=1e-12)


def test_two_poles_of_a_harmonic_are_exact():
    got = ForceFilter(TAU, poles="two").recorded(jnp.asarray(np.cos(3 * PHASE)[None]), LOOP)
    x = 3 * 2 * np.pi * F * TAU
    weaker, later = 1 / np.sqrt(1 + x**4), np.arctan2(np.sqrt(2) * x, 1 - x**2)
    np.testing.assert_allclose(got[0], weaker * np.cos(3 * PHASE - later), atol=1e-12)


def test_two_poles_of_a_ramp_on_an_uneven_grid():
    """Behind them a ramp r becomes r − √2 τ (1 − e^{−a r} cos a r), a = 1/√2 τ."""
    t, motion = record()
    since, late = t - t[0], np.sqrt(2) * 0.02
    got = ForceFilter(0.02, poles="two").recorded(jnp.asarray(since), motion)
    left = np.exp(-since / late) * np.cos(since / late)
    np.testing.assert_allclose(got, since - late * (1 - left), atol=1e-12)


def test_nothing_of_the_future_is_used():
    t, motion = record()
    signal = np.sin(40 * t)
    changed = np.where(t > 0.2, 7.0, signal)
    for effect in (ForceDelay(1e-3), ForceFilter(1e-3), ForceFilter(1e-3, poles="two")):
        one = np.asarray(effect.recorded(jnp.asarray(signal), motion))
        two = np.asarray(effect.recorded(jnp.asarray(changed), motion))
        assert np.array_equal(one[t <= 0.2], two[t <= 0.2])
        assert np.abs(one - two)[t > 0.21].max() > 1.0


def test_coil_follows_a_step_with_its_time_constant():
    t = np.arange(400) / 1000
    current = np.where(t >= 0.1, 1.0, 0.0)
    motion = time_motion(t, 0.01 * np.sin(30 * t), current=current)
    got = np.asarray(CoilLag(5e-3).current(motion))
    assert got[99] == 0.0
    reached = np.interp(0.6321, got[99:150], t[99:150])
    assert reached - 0.0995 == pytest.approx(5e-3, abs=1e-4)
    constant = eqx.tree_at(lambda m: m.current, motion, jnp.full(1, 0.3))
    assert np.array_equal(CoilLag(5e-3).current(constant), constant.current)
