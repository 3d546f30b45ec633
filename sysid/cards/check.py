"""Check vectors: short motions whose force every reader of a card must reproduce."""

from typing import Final

import numpy as np

from sysid.cards.schema import Check, Validity
from sysid.models.base import AbstractValve
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion
from sysid.motion.time_motion import time_motion

TOLERANCE: Final = 1e-9
"""Largest |error| / max|force|: machines differ in the last digits of exp and tanh only."""

POINTS: Final = 32


def check_vectors(valve: AbstractValve, validity: Validity) -> tuple[Check, ...]:
    """Make the check vectors of a card: loops at three currents and one motion of two sines.

    All lie in the validity box.

    Args:
        valve: The identified model.
        validity: The box.
    """
    low, high = validity.current
    temperature = None if validity.temperature is None else float(np.mean(validity.temperature))
    speed = 0.8 * validity.velocity[1]
    amplitude = validity.amplitude[1]
    omega = speed / amplitude
    phase = 2.0 * np.pi * (np.arange(POINTS) + 0.25) / POINTS
    two_sines = {1: 0.55 * amplitude, 2: 0.2 * amplitude}
    cases = [({1: amplitude}, np.full(POINTS, i)) for i in sorted({low, 0.5 * (low + high), high})]
    cases.append((two_sines, np.linspace(low, high, POINTS)))
    return tuple(_vector(valve, phase, omega, *case, temperature) for case in cases)


def _vector(
    valve: AbstractValve,
    phase: np.ndarray,
    omega: float,
    sines: dict[int, float],
    current: np.ndarray,
    temperature: float | None,
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
        temperature=() if temperature is None else (temperature,) * phase.size,
        force=(0.0,) * phase.size,
        tolerance=TOLERANCE,
    )
    return check.model_copy(update={"force": _series(recompute(valve, check))})


def recompute(valve: AbstractValve, check: Check) -> np.ndarray:
    """Force on the motion of a check vector, [n] N."""
    return np.asarray(simulate(valve, check_motion(check)))


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
