"""The tests that trial campaigns draw from: W11's Table 1 below a peak velocity."""

import math
from itertools import product
from typing import Final

from sysid.rig.bench import Setting

CONDITIONS: Final[tuple[tuple[float, tuple[float, ...]], ...]] = (
    (2.5e-3, (0.1, 0.5, 1.5, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0)),
    (12.5e-3, (0.1, 0.5, 1.5, 2.5, 5.0, 7.5, 10.0, 12.5)),
    (25e-3, (0.1, 0.5, 1.5, 2.5, 5.0, 7.5, 10.0)),
    (50e-3, (0.1, 0.5, 1.5, 2.5, 5.0)),
    (75e-3, (0.1, 0.5, 1.5, 2.5)),
)
"""Amplitude, m, and its frequencies, Hz: the 33 conditions of W11 Table 1."""

CURRENTS: Final = (0.0, 0.1, 0.2, 0.3, 0.4)
"""A."""


def settings_below(peak_velocity: float) -> tuple[Setting, ...]:
    """All tests of W11's Table 1 with Aω up to a peak velocity, m/s."""
    conditions = [
        (a, f)
        for a, frequencies in CONDITIONS
        for f in frequencies
        if 2.0 * math.pi * a * f <= peak_velocity
    ]
    return tuple(Setting(a, f, i) for (a, f), i in product(conditions, CURRENTS))
