"""Steps of the converter that are coarse beside the signal."""

import numpy as np
from jaxtyping import Float

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault, graded
from sysid.data.quality.subject import Subject

NOTE, WARNING = 0.01, 0.05


def check_quantisation(subject: Subject) -> list[Fault]:
    """Resolution beside the displacement's amplitude and the peak force."""
    if subject.loop is None:
        return []
    faults = []
    for name, unit, factor, values, size in (
        ("displacement", "mm", 1e3, subject.record.displacement, subject.loop.amplitude),
        ("force", "N", 1.0, subject.record.force, subject.peak_force),
    ):
        step = resolution(subject.steady_part(values))
        if size == 0.0:
            continue
        text = (
            f"{name} comes in steps of {figure(factor * step)} {unit}, "
            f"{100 * step / size:.1f} % of its size of {figure(factor * size)} {unit}"
        )
        faults += graded("quantisation", step / size, NOTE, WARNING, text)
    return faults


def resolution(values: Float[np.ndarray, " n"]) -> float:
    """The step between levels if a channel has fewer levels than half its samples, else 0."""
    span = float(np.ptp(values))
    if span == 0.0:
        return 0.0
    levels = np.unique(np.round((values - values.min()) / span, 7))
    if levels.size < 2 or levels.size > 0.5 * values.size:
        return 0.0
    return float(np.min(np.diff(levels))) * span
