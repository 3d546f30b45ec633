"""From what happened to what the recorder stores: filters, thermocouple, converter."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.interpolate import PchipInterpolator
from scipy.signal import lfilter

from sysid.rig.bench import Errors
from sysid.rig.chance import Stream
from sysid.rig.excitation import SineRun
from sysid.rig.physical.course import Courses
from sysid.rig.recording import Recording, digitise

Samples = Float[np.ndarray, " n"]
FINE: Final = 10_000.0
"""Least rate at which filters are worked out, Hz."""
_FORCE, _DISPLACEMENT, _CURRENT, _TEMPERATURE = range(1, 5)
"""Streams of random numbers of one test; 0 sets it up."""


@dataclass(frozen=True)
class Channels:
    """The measuring chain.

    Attributes:
        force_corner: Of the load cell's conditioner, Hz: second order, Butterworth.
        displacement_corner: Of the transducer's conditioner, Hz.
        force_range: Full scale of the converter, N.
        bits: Of the converter.
        force_noise: N.
        displacement_noise: m.
        current_noise: A.
        temperature_noise: K.
    """

    force_corner: float = 250.0
    displacement_corner: float = 500.0
    force_range: float = 10_000.0
    bits: int = 16
    force_noise: float = 4.0
    displacement_noise: float = 3e-6
    current_noise: float = 3e-4
    temperature_noise: float = 0.05


def record(
    channels: Channels, courses: Courses, test: int, run: SineRun, rate: int,
    current: float, lag: float, errors: Errors, thermometer: float, key: tuple[int, ...],
) -> Recording:  # fmt: skip
    """What the recorder stores of one test.

    Args:
        channels: The measuring chain.
        courses: What happened.
        test: Column of the test.
        run: Its command.
        rate: Sampling rate, Hz.
        current: A.
        lag: Of the thermocouple, s.
        errors: Gain, offset and delay of the force channel.
        thermometer: Error of the thermocouple, K.
        key: Names the test's random numbers.
    """
    count = int(run.duration * rate) + 1
    time = np.arange(count) / rate
    own = courses.time[:, test] + run.rest

    def at(column: Samples, corner: float, late: float = 0.0) -> Samples:
        """Filtered and sampled; before the motion all is at rest."""
        parts = max(1, math.ceil(FINE / rate)) if corner < 0.5 * FINE else 1
        fine = np.arange((count - 1) * parts + 1) / (rate * parts)
        curve = PchipInterpolator(own, column)(np.clip(fine - late, own[0], own[-1]))
        return low_pass(curve, corner, rate * parts)[::parts]

    true = at(courses.force[:, test], channels.force_corner, errors.delay)
    force = (1.0 + errors.gain) * true + errors.offset
    force = force + channels.force_noise * Stream(*key, _FORCE).normal(count)
    smallest = 2.0 * channels.force_range / 2**channels.bits
    force = smallest * np.rint(
        np.clip(force, -channels.force_range, channels.force_range) / smallest
    )
    ram = at(courses.ram[:, test], channels.displacement_corner)
    ram = ram + channels.displacement_noise * Stream(*key, _DISPLACEMENT).normal(count)
    noise = channels.temperature_noise * Stream(*key, _TEMPERATURE).normal(count)
    body = np.interp(time, own, courses.body[:, test])
    shaken = current + channels.current_noise * Stream(*key, _CURRENT).normal(count)
    return Recording(
        rate=rate,
        displacement=digitise(1e6 * ram),
        force=digitise(10.0 * force),
        current=digitise(1e3 * shaken),
        temperature=digitise(10.0 * (behind(body, lag, rate) + thermometer + noise)),
    )


def low_pass(signal: Samples, corner: float, rate: float) -> Samples:
    """Butterworth's filter of second order by the bilinear rule, from rest at the first value."""
    w = math.tan(math.pi * corner / rate)
    scale = 1.0 + math.sqrt(2.0) * w + w * w
    b = np.array([w * w, 2.0 * w * w, w * w]) / scale
    a = np.array([1.0, 2.0 * (w * w - 1.0) / scale, (1.0 - math.sqrt(2.0) * w + w * w) / scale])
    return np.asarray(lfilter(b, a, signal - signal[0])) + signal[0]


def behind(signal: Samples, lag: float, rate: float) -> Samples:
    """A lag of first order, from rest at the first value."""
    share = 1.0 / (1.0 + lag * rate)
    return np.asarray(lfilter([share], [1.0, share - 1.0], signal - signal[0])) + signal[0]
