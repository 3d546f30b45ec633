"""A damper's force turns with the velocity: a magnitude pushes the same way in both strokes."""

import numpy as np

from sysid.data.quality.fault import Fault
from sysid.data.quality.sign import NO_DAMPER
from sysid.data.quality.silence import silence
from sysid.data.quality.subject import Subject

ORDER = 15
"""Harmonics that are looked at: where a damper's force is."""
TIMES = 2.0
"""How many times what the odd harmonics hold the even ones of a damper never hold."""


def check_one_sign(subject: Subject) -> list[Fault]:
    """Whether what repeats with every half cycle is more than what turns its sign with it.

    F(t + T/2) = −F(t) for a force that is alike in both directions, so odd harmonics hold it; one
    whose strokes differ by any factor has less in the even ones, and as much where one stroke has
    no force at all.  A magnitude |F| has even ones alone.  Of the median cycle, since a spike
    has both.  A silent channel is told elsewhere.
    """
    loop = subject.loop
    if loop is None or subject.record.nominal.kind in NO_DAMPER or silence(subject):
        return []
    cycle = np.median(loop.force + loop.deviations, axis=0)
    power = np.abs(np.fft.rfft(cycle)[1 : ORDER + 1]) ** 2
    odd, even = float(power[::2].sum()), float(power[1::2].sum())
    if even <= TIMES * odd:
        return []
    text = (
        f"the force pushes the same way in both strokes: {100 * even / (odd + even):.0f} % of what "
        "varies repeats with every half cycle, where a damper's force turns; a magnitude |F| was "
        "recorded. Export the force with its sign"
    )
    return [Fault("one_sign", "fatal", text)]
