"""A model's points of a cycle: what jumps or rings is not folded into the harmonics compared."""

import numpy as np
import pytest

from sysid.identification.families import family
from sysid.likelihood.compress import HARMONICS, harmonic_basis
from sysid.models.lumped import TABLE_1, Lumped
from sysid.motion.motion import sine_motion
from sysid.parameters import build

NOISE = 0.01 / np.sqrt(1500.0)
"""Of a coefficient, parts of the RMS force: 1 % a sample, three cycles at 2 Hz, 1000 Hz."""
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


@pytest.mark.parametrize("frequency", [2.0, 4.0, 8.0])
def test_what_rings_after_a_reversal_is_not_folded_into_the_lower_harmonics(frequency):
    assert folded(frequency, family("lumped").points) < 0.3


def test_half_as_many_points_would_fold_it():
    assert folded(2.0, family("lumped").points // 2) > 1.0
