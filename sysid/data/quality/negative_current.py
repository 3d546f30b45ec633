"""A current below zero: laws rise with the current, and are known for positive ones only."""

from collections.abc import Iterable
from typing import Final

import numpy as np

from sysid.data.figures import ampere
from sysid.data.quality.fault import Fault
from sysid.data.quality.sign import NO_DAMPER
from sysid.data.quality.subject import Subject
from sysid.data.supply import same_current

SET: Final = 0.05
"""Of the largest current, below zero: no meter's zero any more, but a current that was set."""
SET_LEAST: Final = 0.01
"""A, likewise."""
BRIEF: Final = 0.05
"""Part of a motion's samples that may be lower: ripple and spikes."""


def check_negative_current(subjects: Iterable[Subject]) -> dict[str, list[Fault]]:
    """Tests whose current is below zero by more than a supply scatters.

    A damper's force is that of either sign, so such a current is meant as a positive one, which
    nothing here takes for granted: laws are fitted to currents as they are.

    Args:
        subjects: Tests of one campaign.

    Returns:
        Id → faults.
    """
    lowest = {s.record.id: _lowest(s) for s in subjects if s.record.nominal.kind not in NO_DAMPER}
    largest = max((abs(z) for z in lowest.values() if np.isfinite(z)), default=0.0)
    faults = {}
    for name, current in lowest.items():
        if not current < -same_current(largest):
            continue
        set_so = current < -max(SET * largest, SET_LEAST)
        cure = (
            "the force of a damper does not depend on its sign: write it positive"
            if set_so
            else "the meter's zero? Subtract it"
        )
        text = f"a current of {ampere(current)} is below zero; {cure}"
        faults[name] = [Fault("negative_current", "fatal" if set_so else "warning", text)]
    return faults


def _lowest(subject: Subject) -> float:
    """A, NaN where unknown: of a loop its own, of another motion the lowest that lasts."""
    if subject.loop is not None:
        return subject.loop.current
    recorded, label = subject.record.current, subject.record.nominal.current
    if recorded is not None and np.isfinite(recorded).any():
        return float(np.nanquantile(recorded, BRIEF))
    return float("nan") if label is None else label
