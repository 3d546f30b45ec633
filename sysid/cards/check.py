"""Check vectors: short motions whose force every reader of a card must reproduce."""

from typing import Final

import numpy as np

from sysid.cards.schema import Check, Validity
from sysid.data.supply import same_current
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion
from sysid.motion.time_motion import time_motion

TOLERANCE: Final = 1e-9
"""Largest |error| / max|force|: machines differ in the last digits of exp and tanh only."""

POINTS: Final = 32


def check_vectors(damper: Damper, validity: Validity) -> tuple[Check, ...]:
    """Make a card's check vectors: loops at three currents, and two sines with all else rising.

    All lie in the validity box.  Over the two sines current and temperature go through it.  Where
    the box is one setting of the supply (`same_current`) there is one loop, in its middle.

    Args:
        damper: The identified model with its effects.
        validity: The box.
    """
    low, high = validity.current
    if high - low <= same_current(max(abs(low), abs(high))):
        low = high = 0.5 * (low + high)
    cold, warm = validity.temperature or (np.nan, np.nan)
    temperature = np.full(POINTS, 0.5 * (cold + warm))
    speed = 0.8 * validity.velocity[1]
    amplitude = validity.amplitude[1]
    omega = speed / amplitude
    phase = 2.0 * np.pi * (np.arange(POINTS) + 0.25) / POINTS
    two_sines = {1: 0.55 * amplitude, 2: 0.2 * amplitude}
    cases = [
        ({1: amplitude}, np.full(POINTS, i), temperature)
        for i in sorted({low, 0.5 * (low + high), high})
    ]
    rising = np.linspace(low, high, POINTS)
    cases.append((two_sines, rising, np.linspace(cold, warm, POINTS)))
    return tuple(_vector(damper, phase, omega, *case) for case in cases)


def _vector(
    damper: Damper,
    phase: np.ndarray,
    omega: float,
    sines: dict[int, float],
    current: np.ndarray,
    temperature: np.ndarray,
) -> Check:
    x, v, acceleration = np.zeros((3, phase.size))
    for n, a in sines.items():
        x += a * np.sin(n * phase)
        v += a * n * omega * np.cos(n * phase)
        acceleration -= a * (n * omega) ** 2 * np.sin(n * phase)
    check = Check(
        time=_series((phase - phase[0]) / omega),
        displacement=_series(x),
        velocity=_series(v),
        acceleration=_series(acceleration),
        current=_series(current),
        temperature=_series(temperature) if np.isfinite(temperature).all() else (),
        force=(0.0,) * phase.size,
        tolerance=TOLERANCE,
    )
    return check.model_copy(update={"force": _series(recompute(damper, check))})


def recompute(damper: Damper, check: Check) -> np.ndarray:
    """Force on the motion of a check vector, [n] N."""
    return np.asarray(simulate(damper, check_motion(check)))


def check_motion(check: Check) -> Motion:
    """The motion of a check vector, [n]; sgn ẍ and v_m come from its own numbers alone."""
    x, v, a = (np.array(z) for z in (check.displacement, check.velocity, check.acceleration))
    return time_motion(
        np.array(check.time),
        x,
        velocity=v,
        acceleration=a,
        current=np.array(check.current),
        temperature=np.array(check.temperature or (np.nan,) * x.size),
    )


def _series(values: np.ndarray) -> tuple[float, ...]:
    return tuple(float(z) for z in values)
