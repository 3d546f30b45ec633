"""How a trial campaign is run, and its streams of random numbers."""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

DESIGN, DAMPER, MISFIT, ERRORS, NOISE = range(5)
"""Streams of random numbers of one campaign."""


@dataclass(frozen=True)
class TrialDesign:
    """How a trial campaign is run.

    Attributes:
        fewest: Tests.
        most: Tests.
        points: Of a recorded loop; a divisor of the fine grid's 720.
        cycles: Steady cycles of a test.
        peak_velocity: Highest Aω, m/s.
        model: Law of the damper, "w11" or "bouc_wen".
        parameter_spread: Standard deviation of ln(parameter / published value).
        misfit: ε of `law_factors`; the share of force that a refit leaves follows from it.
        noise: Standard deviation per point and cycle, N; 9 N on 360 points are 4 N on 72.
        relative_noise: The same as a share of the test's RMS force; the larger one counts.
        gain_sd: Relative error of the load cell's gain, over tests.
        offset_sd: Of its zero, N.
        delay_sd: Of the force channel, s.
        amplitude_sd: Relative error of the stroke reached.
        frequency_sd: Relative error of the frequency.
        temperature: °C.
        temperature_sd: Over tests, K.
        displacement_noise: Per point and cycle, m.
        stroke: m, amplitude that damper and rig were built for; the widest of the first tests if
            None.
    """

    fewest: int = 60
    most: int = 110
    points: int = 360
    cycles: int = 8
    peak_velocity: float = 0.4
    model: Literal["w11", "bouc_wen"] = "w11"
    parameter_spread: float = 0.05
    misfit: float = 0.0
    noise: float = 9.0
    relative_noise: float = 0.0
    gain_sd: float = 6e-3
    offset_sd: float = 2.0
    delay_sd: float = 1e-4
    amplitude_sd: float = 4e-3
    frequency_sd: float = 5e-4
    temperature: float = 40.0
    temperature_sd: float = 10.0
    displacement_noise: float = 3e-6
    stroke: float | None = None


STANDARD: Final = TrialDesign()


def random_numbers(seed: int, stream: int, *visit: int) -> np.random.Generator:
    """One stream of a campaign.

    Args:
        seed: Of the campaign.
        stream: Which.
        visit: Number of a later visit to the rig; the first has none.
    """
    return np.random.default_rng([seed, stream, *visit])
