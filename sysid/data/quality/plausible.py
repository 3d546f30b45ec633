"""Numbers that no damper rig gives: a unit is not what header or manifest say."""

from typing import Final

import numpy as np

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.subject import Subject

LARGEST: Final = 2.0
"""m: twice the stroke of the largest dampers of buildings and bridges."""
FASTEST: Final = 20.0
"""m/s: twice what drop towers and shock rigs reach."""
STRONGEST: Final = 1e8
"""N: ten times the largest dampers of buildings."""


def check_plausible(subject: Subject) -> list[Fault]:
    """Amplitude, speed and force of a steady test against what rigs can do.

    Only what is beyond any rig is told: dampers of 5 N and of 5 MN are built, so that kN taken for
    N cannot be seen.  Metres taken for millimetres are no motion (`rest_only`).
    """
    steady = subject.steady
    if steady is None:
        return []
    amplitude, speed = steady.amplitude, 2.0 * np.pi * steady.frequency * steady.amplitude
    told = []
    if amplitude > LARGEST or speed > FASTEST:
        told.append(
            f"an amplitude of {figure(amplitude, 3)} m at {figure(steady.frequency, 3)} Hz, so "
            f"{figure(speed, 3)} m/s, is beyond any rig: millimetres taken for metres, or "
            "milliseconds for seconds?"
        )
    if subject.peak_force > STRONGEST:
        told.append(
            f"a force of {figure(1e-6 * subject.peak_force, 3)} MN is beyond any damper: N taken "
            "for kN?"
        )
    return [
        Fault("implausible", "warning", f"{text} Correct the unit in the header or the manifest")
        for text in told
    ]
