"""A line of the mains in the force: it goes on at its own frequency, whatever the rig does."""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault, graded
from sysid.data.quality.subject import Subject

MAINS: Final = (50.0, 60.0)
"""Hz."""
WANDERS: Final = 0.01
"""Part by which the mains may be off."""
SIZE: Final = (0.001, 0.02)
"""Amplitude over the peak force from which on it is a note, and a warning."""
FALSE_ALARM: Final = 1e-6
"""Chance that noise alone shows a line in a test."""
BESIDE: Final = 8
"""Multiples of the test's frequency on either side at which the same distance is looked at."""
FEWEST_BESIDE: Final = 6
FEWEST_CYCLES: Final = 3
FINER: Final = 4
"""Points of the spectrum for one that the length of the record resolves."""
PER_PERIOD: Final = 2.5
"""Samples of a period that a line needs."""
PHASES: Final = 360


def check_hum(subject: Subject) -> list[Fault]:
    """A line at 50 or 60 Hz that is not a harmonic of the motion.

    The mean cycle is taken off; what is left at the mains frequency f is held against what is left
    at f ± j f_test, for cycles that differ (gain, drift) leave as much there.  With power P and M
    such places the ratio P/P̄ of noise has the tail (1 + x/M)^−M.  Hum whose frequency is a multiple
    of the test's goes into the mean cycle, where nothing tells it from the damper.
    """
    steady, loop = subject.steady, subject.loop
    if steady is None or loop is None or loop.cycles < FEWEST_CYCLES:
        return []
    time = subject.steady_part(subject.record.time)
    span = float(time[-1] - time[0])
    rate = (time.size - 1) / span
    left = without_mean_cycle(steady.phase, subject.steady_part(subject.record.force))
    if not np.all(np.isfinite(left)) or subject.peak_force == 0.0:
        return []
    power, resolution = _spectrum(left, rate)
    found = []
    for mains in MAINS:
        if rate < PER_PERIOD * mains:
            continue
        band = np.arange(*(round(mains * (1.0 + w) / resolution) for w in (-WANDERS, WANDERS)))
        if not band.size:
            continue
        place = int(band[np.argmax(power[band])])
        beside = _beside(power, place, steady.frequency / resolution)
        looked = max(1.0, 2.0 * WANDERS * mains * span)
        if beside.size < FEWEST_BESIDE or not beside.mean() > 0.0:
            continue
        ratio = float(power[place] / beside.mean())
        if looked * (1.0 + ratio / beside.size) ** -beside.size > FALSE_ALARM:
            continue
        near = resolution * np.arange(place - FINER, place + FINER + 1)
        fitted = (_sinusoid(steady.phase, time, left, f) for f in near)
        _, size, frequency = max(z for z in fitted if abs(z[2] / mains - 1.0) <= WANDERS)
        text = (
            f"the force hums with {figure(size)} N at {frequency:.1f} Hz, "
            f"{100 * size / subject.peak_force:.2g} % of its peak, whatever the motion"
        )
        found += graded("mains_hum", size / subject.peak_force, *SIZE, text)
    return found


def without_mean_cycle(
    phase: Float[np.ndarray, " n"], values: Float[np.ndarray, " n"]
) -> Float[np.ndarray, " n"]:
    """What differs from the mean at the same phase.

    Args:
        phase: [n] rad.
        values: [n] any unit.
    """
    turns = phase / (2.0 * np.pi)
    few = max(4, min(PHASES, round(phase.size / (turns[-1] - turns[0]) / 2.0)))
    place = np.floor((turns % 1.0) * few).astype(np.int64) % few
    count = np.maximum(np.bincount(place, minlength=few), 1)
    mean = np.bincount(place, values, few) / count
    at = np.bincount(place, turns % 1.0, few) / count
    return values - np.interp(turns % 1.0, at, mean, period=1.0)


def _spectrum(
    values: Float[np.ndarray, " n"], rate: float
) -> tuple[Float[np.ndarray, " f"], float]:
    """Power of a Hann window's spectrum, in squared amplitudes, and its resolution in Hz."""
    window = np.hanning(values.size)
    length = FINER * 2 ** int(np.ceil(np.log2(values.size)))
    lines = np.fft.rfft((values - values.mean()) * window, length) * (2.0 / window.sum())
    return np.abs(lines) ** 2, rate / length


def _beside(
    power: Float[np.ndarray, " f"], place: int, spacing: float
) -> Float[np.ndarray, " place"]:
    """Power as far from other multiples of the test's frequency, [M]."""
    steps = np.arange(1, BESIDE + 1)
    places = np.rint(place + spacing * np.concatenate([-steps, steps])).astype(np.int64)
    least = place // 4
    return power[places[(places > least) & (places < power.size)]]


def _sinusoid(
    phase: Float[np.ndarray, " n"],
    time: Float[np.ndarray, " n"],
    left: Float[np.ndarray, " n"],
    frequency: float,
) -> tuple[float, float, float]:
    """Energy that a sinusoid explains where the mean cycle took its part, amplitude, frequency."""
    turn = 2.0 * np.pi * frequency * (time - time[0])
    basis = np.stack([without_mean_cycle(phase, wave(turn)) for wave in (np.sin, np.cos)])
    share = np.linalg.lstsq(basis @ basis.T, basis @ left, rcond=1e-3)[0]
    return float(share @ (basis @ left)), float(np.hypot(*share)), frequency
