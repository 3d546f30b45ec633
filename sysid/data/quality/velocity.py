"""A recorded velocity against the derivative of the displacement."""

import numpy as np

from sysid.data.harmonics import fit_harmonics
from sysid.data.quality.fault import Fault, graded
from sysid.data.quality.subject import Subject

SCALE = (0.02, 0.05)
DELAY = (0.0175, 0.0873)
"""Departure of the ratio's size from 1, and of its angle from 0 in rad (1° and 5°), from which on
it is a note, and a warning."""


def check_velocity(subject: Subject) -> list[Fault]:
    """Ratio of the fundamentals: v_1/(i ω x_1) = scale·e^{−i ω delay}."""
    steady, record = subject.steady, subject.record
    if steady is None or record.velocity is None:
        return []
    velocity = subject.steady_part(record.velocity)
    if not np.all(np.isfinite(velocity)):
        return []
    x = fit_harmonics(steady.phase, subject.steady_part(record.displacement), 3).harmonics[0]
    v = fit_harmonics(steady.phase, velocity, 3).harmonics[0]
    omega = 2.0 * np.pi * steady.frequency
    ratio = complex(v / (1j * omega * x))
    if ratio.real < 0.0:
        text = "the recorded velocity has the opposite sign of the displacement's derivative"
        return [Fault("velocity_scale", "warning", text)]
    scale, angle = abs(ratio), float(np.angle(ratio))
    faults = graded(
        "velocity_scale",
        abs(scale - 1.0),
        *SCALE,
        f"the recorded velocity is {scale:.3f} times the displacement's derivative",
    )
    step = float(np.median(np.diff(record.time)))
    delay = -angle / omega
    if abs(delay) > 0.5 * step:
        word = "late" if delay > 0 else "early"
        text = (
            f"the recorded velocity is {1e3 * abs(delay):.3g} ms {word} against the "
            f"displacement's derivative ({abs(np.degrees(angle)):.1f}°)"
        )
        faults += graded("velocity_delay", abs(angle), *DELAY, text)
    return faults
