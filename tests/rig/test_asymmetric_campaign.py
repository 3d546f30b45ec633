"""The dataset of W11's asymmetric current: its own physics against the simulators'."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.drive.coil_lag import CoilLag
from sysid.isolator.asymmetric_current import Asymmetry
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.motion import Motion
from sysid.parameters import build
from sysid.rig.arctangent import angle
from sysid.rig.asymmetric_drive import AsymmetricDrive
from sysid.rig.damper import HystereticDamper
from sysid.rig.excitation import SineRun, State
from sysid.rig.scenarios.virtual_asymmetric import VIRTUAL_ASYMMETRIC
from sysid.rig.truth import open_seal

DATASET = Path(__file__).parents[2] / "datasets" / "virtual-asymmetric"
LAG = VIRTUAL_ASYMMETRIC.drive.lag
POINTS, LONGEST = 2000, 3200
TRUTH = open_seal(DATASET / "sealed" / "truth.json")


def _state(velocity: np.ndarray, peak: float) -> State:
    side = np.where(np.arange(velocity.size) % 2 == 0, 1.0, -1.0)
    return State(np.zeros_like(velocity), velocity, side, np.full_like(velocity, peak))


def _cycle(true: Mapping[str, Any], angle: np.ndarray) -> Motion:
    """The sealed motion of a test in its steady cycles, without its current."""
    omega = 2 * np.pi * true["frequency"]
    v = np.cos(angle)
    for order, size, lead in true["harmonics"]:
        v = v + order * size * np.cos(order * angle + 2 * np.pi * lead)
    return Motion(
        displacement=jnp.asarray(true["amplitude"] * np.sin(angle)),
        velocity=jnp.asarray(true["amplitude"] * omega * v),
        acceleration=jnp.asarray(-true["amplitude"] * omega**2 * np.sin(angle)),
        acceleration_sign=jnp.asarray(-np.sign(np.sin(angle))),
        peak_velocity=jnp.asarray([true["amplitude"] * omega]),
        current=jnp.asarray([true["current"]]),
        temperature=jnp.asarray([40.0]),
        time=jnp.asarray(angle / omega),
        frequency=jnp.asarray([true["frequency"]]),
        periodic=True,
    )


def _coil_current(true: Mapping[str, Any], angle: np.ndarray) -> np.ndarray:
    """By the simulators' algorithm and the catalogue's lag, A at the given phases."""
    grid = 2 * np.pi * np.arange(POINTS) / POINTS
    motion = Asymmetry(0.0, 2.0).driven(_cycle(true, grid))
    late = np.asarray(CoilLag(tau_i=jnp.asarray(LAG)).current(motion))
    return np.interp(angle, grid, late, period=2 * np.pi)


def test_angle_of_points_is_right_to_the_last_digits():
    rng = np.random.default_rng(1)
    over, along = np.exp(rng.uniform(-40.0, 40.0, (2, 20_000)))
    np.testing.assert_allclose(angle(over, along), np.arctan2(over, along), rtol=1e-15)
    zero, one = np.zeros(3), np.array([0.0, 1.0, 1e-300])
    np.testing.assert_array_equal(angle(zero, one), np.arctan2(zero, one))
    assert angle(np.ones(1), np.zeros(1))[0] == 0.5 * np.pi


@pytest.mark.parametrize(("p", "zeta"), [(0.0, 2.0), (0.3, 10.0), (1.0, 2.0)])
def test_controller_asks_for_what_the_simulators_ask_for(p, zeta):
    velocity = np.linspace(-0.3, 0.3, 1001)
    asked = AsymmetricDrive(p, zeta, LAG).asked(_state(velocity, 0.2))
    other = Asymmetry(p, zeta).multiplier(jnp.asarray(velocity), jnp.asarray([0.2]))
    np.testing.assert_allclose(asked, np.asarray(other), rtol=0, atol=1e-15)


@pytest.mark.parametrize(("frequency", "rate"), [(0.5, 200), (1.5, 500)])
def test_coil_follows_as_the_catalogue_has_it(frequency, rate):
    run = SineRun(0.0125, frequency, 0.0, (), 0.15, 1.5, 8.0, 1.0)
    count = int(run.duration * rate) + 1
    current = VIRTUAL_ASYMMETRIC.drive.current(run, 0.0, count, rate, 0.3)
    turns = (np.arange(count) / rate - 0.15) * frequency
    steady = (turns > 2.0) & (turns < 9.4)
    true = {"amplitude": 0.0125, "frequency": frequency, "harmonics": [], "current": 0.3}
    expected = _coil_current(true, 2 * np.pi * turns[steady])
    np.testing.assert_allclose(current[steady], expected, rtol=0, atol=3e-5)
    assert current[0] == pytest.approx(0.15)
    assert current.min() < 0.05
    assert current.max() > 0.25


@pytest.mark.parametrize("current", [0.0, 0.05, 0.2, 0.4])
def test_force_at_a_current_that_stays_is_that_at_the_one_current(current):
    state, damper = _state(np.linspace(-0.3, 0.3, 301), 0.2), HystereticDamper(LOW_SYMMETRIC)
    np.testing.assert_array_equal(
        damper.force(state, np.full(301, current)), damper.force(state, current)
    )


def test_each_file_is_the_symmetric_model_at_the_coil_s_current():
    valve = build(Generalized, LOW_SYMMETRIC)
    for stem, true in TRUTH.tests.items():
        t, _, force, current, _ = np.loadtxt(DATASET / f"{stem}.csv", delimiter=",", skiprows=1).T
        turns = (t - 0.15) * true["frequency"]
        steady = (turns > 2.0) & (turns < 9.4)
        phase = 2 * np.pi * (turns[steady] - true["delay"] * true["frequency"])
        # one length for all files, so that JAX compiles its operations once
        padded = np.pad(phase, (0, LONGEST - phase.size), mode="edge")
        coil = jnp.asarray(_coil_current(true, padded))
        motion = _cycle(true, padded)
        driven = Motion(**{**vars(motion), "current": coil, "periodic": False})
        expected = (1.0 + true["gain"]) * np.asarray(valve.force(driven))[: phase.size]
        expected += true["offset"]
        noise, rms = force[steady] - expected, np.sqrt(np.mean(expected**2))
        assert np.std(noise) / rms == pytest.approx(0.01, rel=4 / np.sqrt(2 * noise.size) + 0.02)
        assert abs(np.mean(noise)) < 4 * np.std(noise) / np.sqrt(noise.size), stem
        # what is recorded is the command
        assert np.mean(current) == pytest.approx(true["current"], abs=1e-4)


def test_truth_names_what_is_hidden():
    assert TRUTH.parameters == LOW_SYMMETRIC
    (hidden,) = TRUTH.effects
    assert hidden["id"] == "asymmetric_current"
    assert (hidden["compression"], hidden["smoothing"], hidden["lag"]) == (0.0, 2.0, LAG)
