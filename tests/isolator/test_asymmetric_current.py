"""W11's ADFG against the numbers of its text and of the project's reading."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.drive.coil_lag import CoilLag
from sysid.errors import DataError
from sysid.isolator.asymmetric_current import Asymmetry, asymmetric_sines, ratios_of
from sysid.models.damper import Damper
from sysid.models.generalized import ASYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.motion.motion import sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build


def at(asymmetry, velocity, peak=0.2):
    return float(asymmetry.multiplier(jnp.asarray([float(velocity)]), jnp.asarray([peak]))[0])


def test_it_reaches_what_the_reading_says():
    one = Asymmetry(0.0, 2.0)
    assert at(one, 0.2) == pytest.approx(0.148, abs=5e-4)
    assert at(one, -0.2) == pytest.approx(0.852, abs=5e-4)
    assert at(one, 0.0) == 0.5
    sharp = Asymmetry(0.3, 1e9)
    assert at(sharp, 0.1) == pytest.approx(0.3)
    assert at(sharp, -0.1) == pytest.approx(1.0)


def test_it_is_defined_at_rest_and_on_any_motion():
    one = Asymmetry()
    assert at(one, 0.0, peak=0.0) == 0.5
    t = np.linspace(0.0, 1.0, 500)
    moved = np.where(t < 0.5, 0.0, 0.01 * np.sin(2 * np.pi * 3 * (t - 0.5)) ** 3)
    motion = one.driven(time_motion(t, moved, current=0.3))
    current = np.asarray(motion.current)
    assert np.all(np.isfinite(current))
    assert 0.0 <= current.min() < 0.05
    assert 0.25 < current.max() <= 0.3


def test_without_asymmetry_nothing_changes():
    motion = sine_motion(0.01, 2.0, 0.3)
    np.testing.assert_allclose(Asymmetry(1.0, 2.0).driven(motion).current, 0.3)


def test_a_symmetric_damper_gets_a_ratio_that_falls_with_speed():
    """The direction of W11's "order of 4 … approximately 2"; its published model: 3.7 → 2.6."""
    frequencies = [0.5, 1.5]
    lagging = Damper(build(Generalized, LOW_SYMMETRIC)).with_effect(CoilLag(tau_i=0.005))
    found = ratios_of(lagging, asymmetric_sines(Asymmetry(), 0.0125, frequencies, [0.0, 0.3]))
    idle, driven = found.at_peak.reshape(2, 2).T
    np.testing.assert_allclose(idle, 1.0, rtol=1e-6)
    assert np.all(driven > 1.5)
    assert driven[1] < driven[0]
    published = ratios_of(
        build(Generalized, ASYMMETRIC), sine_motion(0.0125, np.array([0.5, 3.0]), 0.3)
    )
    assert published.at_peak[0] == pytest.approx(3.7, abs=0.15)


def test_a_slow_coil_blunts_it():
    motion = asymmetric_sines(Asymmetry(), 0.0125, [2.5], [0.3])
    valve = Damper(build(Generalized, LOW_SYMMETRIC))
    quick, slow = (
        ratios_of(valve.with_effect(CoilLag(tau_i=tau)), motion).at_peak for tau in (0.001, 0.2)
    )
    assert slow[0] < quick[0]


@pytest.mark.parametrize("bad", [(-0.1, 2.0), (1.2, 2.0), (0.5, 0.0), (0.5, float("inf"))])
def test_senseless_numbers_are_refused(bad):
    with pytest.raises(DataError, match="no asymmetry"):
        Asymmetry(*bad)


def test_the_defect_of_the_published_model_at_zero_current():
    """No current can be modulated at 0 A, yet Table 3's model is asymmetric there."""
    found = ratios_of(build(Generalized, ASYMMETRIC), sine_motion(0.0125, 0.5, 0.0))
    assert found.at_peak[0] > 1.0
    idle = eqx.tree_at(lambda m: m.current, sine_motion(0.0125, 0.5, 0.0), jnp.zeros((1, 1)))
    assert np.isfinite(ratios_of(build(Generalized, ASYMMETRIC), idle).of_extremes).all()
