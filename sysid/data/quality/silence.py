"""Whether the force channel records anything of the damper."""

import numpy as np
from jaxtyping import Float

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.subject import Subject

NO_DAMPER = ("rod_disconnected", "tare")
"""Kinds of test in which there is no damper to record."""
HARMONICS = slice(1, 6)
"""Where a damper's force is; a cable that is off hears the mains beyond them."""
FAINT = 2.0
"""What repeats with the motion, beside what scatter alone would leave in the mean cycle, below
which nothing is heard: 1 for noise alone, some hundreds for dampers."""


def check_silence(subject: Subject) -> list[Fault]:
    """A force that never changes, or of which no part follows the motion: a cable off, a switch."""
    evidence = silence(subject)
    return [] if evidence is None else [Fault("no_force", "fatal", evidence)]


def silence(subject: Subject) -> str | None:
    """Why the force channel counts as silent, one sentence; None where it does not.

    In its first five harmonics: where C cycles scatter by σ about their mean, noise alone leaves
    σ/√C in that mean.  Of other motion than a sine there is no mean cycle, and only a force that
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
    if loop is None or loop.cycles < 2:
        return None
    repeats = _rms(loop.force[None])
    scatter = _rms(loop.deviations) * np.sqrt(loop.cycles / (loop.cycles - 1))
    chance = scatter / np.sqrt(loop.cycles)
    if repeats > FAINT * chance:
        return None
    return (
        f"the force does not follow the motion: {figure(repeats)} N RMS repeat from cycle to cycle "
        f"where noise alone would leave {figure(chance)} N, about a mean of "
        f"{figure(float(np.mean(loop.force)))} N"
    )


def _rms(cycles: Float[np.ndarray, "cycle phase"]) -> float:
    """Of the first harmonics, N."""
    lines = np.fft.rfft(cycles, axis=1)[:, HARMONICS] / cycles.shape[1]
    return float(np.sqrt(2.0 * np.mean(np.sum(np.abs(lines) ** 2, axis=1))))
