"""The laboratory's damper against the model that is fitted to it, and against published values."""

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.models.generalized import ASYMMETRIC, HIGH_SYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.motion.motion import sine_motion
from sysid.parameters import build
from sysid.rig.damper import HystereticDamper
from sysid.rig.excitation import State

CONDITIONS = [(2.5e-3, 15.0), (12.5e-3, 0.5), (12.5e-3, 2.5), (25e-3, 1.5)]


def _loop(parameters: dict[str, float], amplitude: float, frequency: float, current: float):
    """The same steady loop from the laboratory and from the model, [360] N each."""
    motion = sine_motion(np.array([amplitude]), np.array([frequency]), np.array([current]))
    v = np.asarray(motion.velocity)[0]
    state = State(
        displacement=np.asarray(motion.displacement)[0],
        velocity=v,
        acceleration_sign=np.asarray(motion.acceleration_sign)[0],
        peak_velocity=np.full(v.shape, float(motion.peak_velocity[0, 0])),
    )
    own = HystereticDamper(parameters).force(state, current)
    return own, np.asarray(build(Generalized, parameters).force(motion))[0]


@pytest.mark.parametrize("table", [LOW_SYMMETRIC, HIGH_SYMMETRIC, ASYMMETRIC])
@pytest.mark.parametrize("current", [0.0, 0.05, 0.2, 0.4])
@pytest.mark.parametrize(("amplitude", "frequency"), CONDITIONS)
def test_agrees_with_the_model(table, amplitude, frequency, current):
    own, model = _loop(table, amplitude, frequency, current)
    assert model.dtype == jnp.float64
    np.testing.assert_allclose(own, model, rtol=0, atol=1e-9 * np.max(np.abs(model)))


def test_agrees_where_the_force_gain_is_clipped_at_one():
    falling = LOW_SYMMETRIC | {"I_0": 0.2}
    for current in (-0.3, -0.1):
        own, model = _loop(falling, 12.5e-3, 1.5, current)
        passive, _ = _loop(falling | {"k_2": 0.0}, 12.5e-3, 1.5, current)
        np.testing.assert_allclose(own, model, rtol=0, atol=1e-9 * np.max(np.abs(model)))
        assert np.array_equal(own, passive)


@pytest.mark.parametrize(
    ("table", "amplitude", "frequency", "highest"),
    [
        (LOW_SYMMETRIC, 12.5e-3, 1.5, [301, 708, 980, 1137, 1221]),
        (LOW_SYMMETRIC, 12.5e-3, 2.5, [389, 914, 1265, 1468, 1576]),
        (HIGH_SYMMETRIC, 2.5e-3, 10.0, [347, 799, 1196, 1383, 1446]),
        (ASYMMETRIC, 12.5e-3, 0.5, [192, 244, 234, 208]),
    ],
)
def test_published_peaks(table, amplitude, frequency, highest):
    for number, value in enumerate(highest):
        own, _ = _loop(table, amplitude, frequency, 0.1 * number)
        assert np.max(own) == pytest.approx(value, abs=1.0)


def test_published_peaks_in_rebound_of_the_asymmetric_set():
    for number, value in enumerate([-230, -470, -667, -809]):
        own, _ = _loop(ASYMMETRIC, 12.5e-3, 0.5, 0.1 * number)
        assert np.min(own) == pytest.approx(value, abs=1.0)
