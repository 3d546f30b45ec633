"""A model's points of a cycle: what jumps or rings is not folded into the harmonics compared."""

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.identification.families import family
from sysid.likelihood.compress import HARMONICS, harmonic_basis
from sysid.likelihood.observed import observe
from sysid.models.lumped import TABLE_1, Lumped
from sysid.motion.motion import sine_motion
from sysid.parameters import build
from tests.data.loop_of import loops_of

NOISE = 0.01 / np.sqrt(1500.0)
"""Of a coefficient, parts of the RMS force: 1 % a sample, three cycles at 2 Hz, 1000 Hz."""
ALLOWED = 0.3
"""Of the noise of a coefficient."""
FINE = 2880
"""Points on which nothing is folded that matters."""


def harmonics(frequency: float, points: int) -> np.ndarray:
    """[L, m] N of BS09's damper at 15, 45 and 75 °C with 0, 0.4 and 1 A, as fast as 5 mm 4 Hz."""
    current, warm = (z.ravel() for z in np.meshgrid([0.0, 0.4, 1.0], [15.0, 45.0, 75.0]))
    motion = sine_motion(20e-3 / frequency, frequency, current, warm, points=points)
    columns = harmonic_basis(points, HARMONICS).columns / points
    return np.asarray(build(Lumped, TABLE_1).force(motion)) @ columns


def folded(frequency: float, points: int) -> float:
    """RMS of what is folded into a coefficient, of the worst test, parts of its noise."""
    fine = harmonics(frequency, FINE)
    left = np.sqrt(np.mean((harmonics(frequency, points) - fine) ** 2, axis=1))
    return float((left / np.sqrt(np.sum(fine**2, axis=1))).max() / NOISE)


def loops_at(frequency: float, points: int = 360) -> Loops:
    """BS09's damper at 1 A, loops as a rig records them: means about each point."""
    fine, (amplitude, count) = FINE // points, (20e-3 / frequency, 1)
    motion = sine_motion(amplitude, frequency, 1.0, 15.0, points=FINE)
    force = np.asarray(build(Lumped, TABLE_1).force(motion))
    about = sum(np.roll(force, k, axis=1) for k in range(-(fine // 2), fine // 2 + 1))
    mean = (about - 0.5 * (np.roll(force, fine // 2, 1) + np.roll(force, -(fine // 2), 1))) / fine
    return loops_of(
        mean[:, ::fine], np.full(count, amplitude), np.full(count, frequency), np.ones(count)
    )


@pytest.mark.parametrize("frequency", [0.5, 1.0, 2.0, 4.0, 8.0])
def test_what_rings_after_a_reversal_is_not_folded_into_the_lower_harmonics(frequency):
    points = family("lumped").points_for(loops_at(frequency))
    assert folded(frequency, points) < ALLOWED


@pytest.mark.parametrize(("frequency", "points"), [(2.0, 180), (1.0, 360), (0.5, 360)])
def test_fewer_points_would_fold_it(frequency, points):
    assert folded(frequency, points) > ALLOWED


def test_a_rig_that_scatters_about_two_hertz_needs_no_more_points():
    """A frequency of 1.99 Hz would otherwise make every test of the campaign twice as dear."""
    assert family("lumped").points_for(loops_at(1.99)) == 360


@pytest.mark.parametrize("model", ["generalized", "tanh", "dahl", "bouc_wen", "modified_bouc_wen"])
def test_a_model_in_which_nothing_rings_needs_no_more_in_slow_tests(model):
    own = family(model)
    assert own.points_for(loops_at(0.1)) == own.points
    assert own.points_for(loops_at(0.1, points=72)) == 72


def test_on_more_points_than_measured_the_motion_is_the_same():
    loops = loops_at(1.0)
    seen = observe(loops, points=720)
    assert seen.force.shape == (1, 720)
    for name in ("displacement", "velocity", "acceleration"):
        finer = getattr(sine_motion(20e-3, 1.0, 1.0, 15.0, points=720), name)
        np.testing.assert_allclose(getattr(seen.motion, name)[:1], finer, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(seen.force[:, ::2], loops.force, atol=1e-9 * np.ptp(loops.force))
    np.testing.assert_allclose(seen.measured, observe(loops).measured)
