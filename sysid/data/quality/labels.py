"""Frequency and amplitude as measured, against the label."""

import math
from collections.abc import Sequence
from typing import Final, Literal

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault, Kind, graded
from sysid.data.quality.subject import Subject

FREQUENCY = (0.01, 0.05)
AMPLITUDE = (0.05, 0.10)
"""Relative departure from the label from which on it is a note, and a warning."""
CONVENTIONS = ((2.0, "half"), (0.5, "twice"), (6.2832, "1/(2π) of"), (0.15915, "2π times"))
"""Label over measured value where a label is peak to peak, or in radians a second."""
UNITS = ((1e3, "1/1000 of"), (1e-3, "1000 times"), (25.4, "1/25.4 of"), (1.0 / 25.4, "25.4 times"))
"""The same where one of the two is in another unit: the test may be 1000 times as large as it is
read."""
NEAR = 0.02
"""Relative distance from such a factor within which it is meant."""
_KINDS: Final[dict[str, Kind]] = {
    "frequency": "frequency_mislabelled",
    "amplitude": "amplitude_mislabelled",
}


def check_labels(subject: Subject) -> list[Fault]:
    """Compare the fundamental's frequency and amplitude with the label, where there is one."""
    steady, nominal = subject.steady, subject.record.nominal
    if steady is None:
        return []
    faults = []
    if nominal.frequency is not None:
        faults += _held_against("frequency", steady.frequency, nominal.frequency, FREQUENCY)
    if nominal.amplitude is not None:
        faults += _held_against("amplitude", steady.amplitude, nominal.amplitude, AMPLITUDE)
    return faults


def _held_against(
    name: Literal["frequency", "amplitude"],
    measured: float,
    label: float,
    grades: tuple[float, float],
) -> list[Fault]:
    """What a departure from the label is: nothing, a note, a warning, or another unit."""
    kind = _KINDS[name]
    unit, scale = ("Hz", 1.0) if name == "frequency" else ("mm", 1e3)
    if label == 0.0:
        text = f"the measured {name} is {figure(scale * measured)} {unit}, the label says 0 {unit}"
        return graded(kind, math.inf, *grades, text)
    ratio = measured / label
    text = (
        f"the measured {name} is {figure(scale * measured)} {unit}, "
        f"{100 * (ratio - 1.0):+.1f} % from the label of {figure(scale * label)} {unit}"
    )
    other_unit = _times(ratio, UNITS)
    if other_unit is not None:
        text += (
            f" ({other_unit} the label): one of the two is in another unit; correct the unit in "
            "the header or in the manifest, or the label"
        )
        return [Fault(kind, "fatal", text)]
    convention = _times(ratio, CONVENTIONS)
    if convention is not None:
        text += f" ({convention} the label: peak to peak, or radians?)"
    return graded(kind, abs(ratio - 1.0), *grades, text)


def _times(ratio: float, factors: Sequence[tuple[float, str]]) -> str | None:
    """Which of some factors a measured value is of its label, in words."""
    return next((word for factor, word in factors if abs(ratio * factor - 1.0) < NEAR), None)
