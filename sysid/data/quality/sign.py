"""A damper takes energy out: there is a force, and it agrees with velocity in sign on the whole."""

import numpy as np

from sysid.data.quality.fault import Fault
from sysid.data.quality.silence import silence
from sysid.data.quality.subject import Subject

NEGATIVE = -0.05
"""∫F dx over ∫|F − mean||dx| below which energy comes out of the damper: +0.6 … 1 for dampers, 0
for a spring or noise."""
NO_DAMPER = ("rod_disconnected", "tare")
"""Kinds of test in which there is no damper."""


def check_sign(subject: Subject) -> list[Fault]:
    """Work done on the damper, relative to the largest that such force and travel could do.

    A force channel that is silent is told instead: noise does work of either sign.
    """
    record = subject.record
    if record.nominal.kind in NO_DAMPER or subject.reason in ("rest_only", "not_finite"):
        return []
    nothing = silence(subject)
    if nothing:
        return [Fault("no_force", "fatal", nothing)]
    if subject.loop is not None:
        force, step = subject.loop.force, subject.loop.velocity
    else:
        force = 0.5 * (record.force[1:] + record.force[:-1])
        step = np.diff(record.displacement)
        known = np.isfinite(force) & np.isfinite(step)
        force, step = force[known], step[known]
    if force.size == 0:
        return []
    force = force - np.mean(force)
    most = float(np.sum(np.abs(force) * np.abs(step)))
    share = float(force @ step) / most if most > 0.0 else 0.0
    if share >= NEGATIVE:
        return []
    text = (
        f"the force opposes the velocity: the work done on the damper is {100 * share:.0f} % of "
        "the most that this force could do over this travel, so energy would come out; the sign "
        "of force or displacement is not as the manifest says"
    )
    return [Fault("wrong_sign", "fatal", text)]
