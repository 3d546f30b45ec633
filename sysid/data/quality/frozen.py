"""A force channel that holds one value while the damper moves: a logger or an amplifier froze."""

import numpy as np

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.subject import Subject
from sysid.data.steady import longest_true

LONGEST = 0.6
"""Part of a cycle: more than half of one holds a reversal, at which a damper's force turns."""


def check_frozen(subject: Subject) -> list[Fault]:
    """Exactly the same force, sample after sample, for more than `LONGEST` of a steady cycle.

    A force that is the same throughout is told as none at all (`silence`).
    """
    steady = subject.steady
    if steady is None:
        return []
    force = subject.steady_part(subject.record.force)
    same = force[1:] == force[:-1]
    if not same.any() or same.all():
        return []
    first, last = longest_true(same)
    cycles = float(steady.phase[last] - steady.phase[first]) / (2.0 * np.pi)
    if cycles <= LONGEST:
        return []
    time = subject.record.time[steady.start : steady.stop]
    text = (
        f"the force stays at exactly {figure(float(force[first]))} N for {figure(cycles, 2)} "
        f"cycles of the motion, from {time[first]:.4g} to {time[last]:.4g} s: the channel froze"
    )
    return [Fault("dropout", "fatal", text)]
