"""Where the steps of a test lie: close about the reversals, where the force changes fastest."""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.rig.elementary import sine

GRADING: Final = 0.7
"""Steps at the reversals are 1 − this times the mean, at mid-stroke 1 + this times it."""
RESTING: Final = 48
"""Steps of the rest after the motion."""


def graded_turns(cycles: float, points: int) -> Float[np.ndarray, " step"]:
    """Ends of the steps in turns of the sinusoid, from 0.

    u = θ + c/(4π) sin 4πθ with equal steps in θ.

    Args:
        cycles: Of the whole motion; a multiple of half a cycle.
        points: Steps a cycle.
    """
    theta = np.arange(round(cycles * points) + 1) / points
    return theta + GRADING / (4.0 * np.pi) * sine(2.0 * theta)


def resting_share() -> Float[np.ndarray, "step 1"]:
    """Ends of the steps after the motion as shares of the rest: short ones first."""
    return (np.arange(1.0, RESTING + 1.0)[:, None] / RESTING) ** 2
