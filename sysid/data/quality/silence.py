"""Whether the force channel records anything of the damper."""

import numpy as np

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.subject import Subject

NO_DAMPER = ("rod_disconnected", "tare")
"""Kinds of test in which there is no damper to record."""
HARMONICS = slice(1, 6)
"""Where a damper's force is; a cable that is off hears the mains beyond them."""
FAINT = 3.0
"""What repeats with the motion, beside what scatter alone would leave in the median cycle, below
which nothing is heard: 1 for noise alone, some hundreds for dampers."""
NORMAL = 1.4826
"""Standard deviation over median magnitude, of Gaussian noise."""


def check_silence(subject: Subject) -> list[Fault]:
    """A force that never changes, or of which no part follows the motion: a cable off, a switch."""
    evidence = silence(subject)
    return [] if evidence is None else [Fault("no_force", "fatal", evidence)]


def silence(subject: Subject) -> str | None:
    """Why the force channel counts as silent, one sentence; None where it does not.

    In the first five harmonics: where samples of C cycles scatter by σ, noise alone leaves
    σ √(10/n)/√C in the median cycle, n the samples a cycle.  Medians, since a spike in one cycle
    outweighs a damper.  Of other motion than a sine there are no cycles, and only a force that
    never changes is silent.

    Args:
        subject: A test.
    """
    record, loop = subject.record, subject.loop
    if record.nominal.kind in NO_DAMPER or subject.reason in ("rest_only", "not_finite"):
        return None
    force = subject.steady_part(record.force)
    if force.size > 1 and np.all(force == force[0]):
        return (
            f"the force is {figure(force[0])} N at every sample: the channel records nothing of "
            "the damper"
        )
    steady = subject.steady
    if loop is None or steady is None or loop.cycles < 2:
        return None
    lines = np.fft.rfft(np.median(loop.force + loop.deviations, axis=0))[HARMONICS]
    repeats = float(np.sqrt(2.0 * np.sum(np.abs(lines) ** 2))) / loop.force.size
    scatter = NORMAL * np.median(np.abs(loop.deviations)) / np.sqrt(1.0 - 1.0 / loop.cycles)
    independent = min(steady.samples_per_cycle, loop.force.size)
    chance = scatter * np.sqrt(2.0 * lines.size / independent / loop.cycles)
    if repeats > FAINT * chance:
        return None
    return (
        f"the force does not follow the motion: {figure(repeats)} N RMS repeat from cycle to cycle "
        f"where noise alone would leave {figure(chance)} N, about a mean of "
        f"{figure(float(np.mean(loop.force)))} N"
    )
