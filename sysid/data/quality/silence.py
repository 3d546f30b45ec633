"""Whether the force channel records anything of the damper."""

import numpy as np

from sysid.data.figures import figure
from sysid.data.quality.resolution import resolution
from sysid.data.quality.subject import Subject

LOWEST = slice(1, 6)
"""Harmonics where a damper's force is; a cable that is off hears the mains beyond them."""
FAINT = 3.0
"""What repeats with the motion, beside what scatter alone would leave in the median cycle, below
which nothing is heard: 1 for noise alone, some hundreds for dampers."""
NORMAL = 1.4826
"""Standard deviation over median magnitude, of Gaussian noise."""


def silence(subject: Subject) -> str | None:
    """Why the force channel counts as silent, one sentence with numbers in N; None if it does not.

    In the first five harmonics: where samples of C cycles scatter by σ, noise alone leaves
    σ √(10/n)/√C in the median cycle, n the samples a cycle; a converter in steps q scatters by
    q/√12 at least.  Medians, since a spike in one cycle outweighs a damper.  Of other motion than
    a sine there are no cycles, and only a force that never changes is silent.

    Args:
        subject: A test with a damper in the rig, that moves.
    """
    steady, loop = subject.steady, subject.loop
    force = subject.steady_part(subject.record.force)
    if force.size > 1 and np.all(force == force[0]):
        return (
            f"the force is {figure(force[0])} N at every sample: the channel records nothing of "
            "the damper"
        )
    if loop is None or steady is None or loop.cycles < 2:
        return None
    lines = np.fft.rfft(np.median(loop.force + loop.deviations, axis=0))[LOWEST]
    repeats = float(np.sqrt(2.0 * np.sum(np.abs(lines) ** 2))) / loop.force.size
    robust = NORMAL * np.median(np.abs(loop.deviations)) / np.sqrt(1.0 - 1.0 / loop.cycles)
    scatter = np.hypot(robust, resolution(force) / np.sqrt(12.0))
    independent = min(steady.samples_per_cycle, loop.force.size)
    chance = scatter * np.sqrt(2.0 * lines.size / independent / loop.cycles)
    if repeats > FAINT * chance:
        return None
    return (
        f"the force does not follow the motion: {figure(repeats)} N RMS repeat from cycle to cycle "
        f"where noise alone would leave {figure(chance)} N, about a mean of "
        f"{figure(float(np.mean(loop.force)))} N"
    )
