"""Frequency and amplitude as measured, against the label."""

import math

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault, graded
from sysid.data.quality.subject import Subject

FREQUENCY = (0.01, 0.05)
AMPLITUDE = (0.05, 0.10)
"""Relative departure from the label from which on it is a note, and a warning."""
MISTAKES = (
    (2.0, "half"), (0.5, "twice"), (6.2832, "1/(2π) of"), (0.15915, "2π times"),
    (1e3, "1/1000 of"), (1e-3, "1000 times"), (25.4, "1/25.4 of"), (1.0 / 25.4, "25.4 times"),
)  # fmt: skip


def check_labels(subject: Subject) -> list[Fault]:
    """Compare the fundamental's frequency and amplitude with the label, where there is one."""
    steady, nominal = subject.steady, subject.record.nominal
    if steady is None:
        return []
    faults = []
    if nominal.frequency is not None:
        size, text = _departure("frequency", steady.frequency, nominal.frequency, "Hz", 1.0)
        faults += graded("frequency_mislabelled", size, *FREQUENCY, text)
    if nominal.amplitude is not None:
        size, text = _departure("amplitude", steady.amplitude, nominal.amplitude, "mm", 1e3)
        faults += graded("amplitude_mislabelled", size, *AMPLITUDE, text)
    return faults


def _departure(
    name: str, measured: float, label: float, unit: str, scale: float
) -> tuple[float, str]:
    """Relative departure and a sentence about it."""
    if label == 0.0:
        moved = f"the measured {name} is {figure(scale * measured)} {unit}, the label says 0 {unit}"
        return math.inf, moved
    ratio = measured / label
    text = (
        f"the measured {name} is {figure(scale * measured)} {unit}, "
        f"{100 * (ratio - 1.0):+.1f} % from the label of {figure(scale * label)} {unit}"
    )
    for factor, word in MISTAKES:
        if abs(ratio * factor - 1.0) < 0.02:
            text += f" ({word} the label: peak to peak, or another unit?)"
            break
    return abs(ratio - 1.0), text
