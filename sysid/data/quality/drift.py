"""Slow change from cycle to cycle: amplitude, centre, force, temperature."""

import numpy as np
from jaxtyping import Float

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault, graded
from sysid.data.quality.subject import Subject

AMPLITUDE = (0.01, 0.03)
CENTRE = (0.01, 0.05)
FORCE = (0.03, 0.10)
TEMPERATURE = (1.0, 5.0)
"""Change over the steady part from which on it is a note, and a warning: relative to the
amplitude, the amplitude, the peak force, and in K."""
NOISE = 4.0
"""Change between cycles, in standard errors of one cycle, below which it is noise."""


def check_displacement_drift(subject: Subject) -> list[Fault]:
    """Amplitude and centre of each cycle."""
    loop = subject.loop
    if loop is None or loop.cycles < 2:
        return []
    n = loop.displacement.size
    path = loop.displacement + loop.displacement_deviations
    turn = np.exp(-2j * np.pi * np.arange(n) / n)
    amplitude = 2.0 * np.abs(path @ turn) / n
    centre = path.mean(axis=1)
    white = _white(loop.displacement_deviations) / np.sqrt(n)
    change, moved = float(np.ptp(amplitude)), float(np.ptp(centre))
    faults = []
    if change > NOISE * np.sqrt(2.0) * white:
        text = (
            f"the amplitude changes between {figure(1e3 * amplitude.min())} and "
            f"{figure(1e3 * amplitude.max())} mm over {loop.cycles} cycles"
        )
        faults += graded("amplitude_drift", change / loop.amplitude, *AMPLITUDE, text)
    if moved > NOISE * white:
        text = (
            f"the centre moves by {figure(1e3 * moved)} mm over {loop.cycles} cycles, "
            f"{100 * moved / loop.amplitude:.1f} % of the amplitude"
        )
        faults += graded("centre_drift", moved / loop.amplitude, *CENTRE, text)
    return faults


def check_force_drift(subject: Subject) -> list[Fault]:
    """Gain and offset of each cycle's force relative to the mean loop.

    F_c(φ) ≈ mean + g_c (F(φ) − mean) + o_c by least squares.
    """
    loop = subject.loop
    if loop is None or loop.cycles < 2:
        return []
    shape = loop.force - loop.force.mean()
    square = float(shape @ shape)
    if square == 0.0:
        return []
    gain = loop.deviations @ shape / square
    offset = loop.deviations.mean(axis=1)
    white, peak = _white(loop.deviations), subject.peak_force
    change, moved = float(np.ptp(gain)) * float(np.ptp(shape)) / 2.0, float(np.ptp(offset))
    faults = []
    if np.ptp(gain) > NOISE * white / np.sqrt(square):
        text = (
            f"the force changes in size between {100 * gain.min():+.1f} and "
            f"{100 * gain.max():+.1f} % of the mean loop over {loop.cycles} cycles"
        )
        faults += graded("force_drift", change / peak, *FORCE, text)
    if moved > NOISE * white / np.sqrt(shape.size):
        text = (
            f"the mean force moves by {figure(moved, 3)} N over {loop.cycles} cycles, "
            f"{100 * moved / peak:.1f} % of the peak"
        )
        faults += graded("force_drift", moved / peak, *FORCE, text)
    return faults


def check_temperature_drift(subject: Subject) -> list[Fault]:
    """Recorded temperature, first against last tenth of the steady part."""
    temperature = subject.record.temperature
    if temperature is None or subject.steady is None:
        return []
    part = subject.steady_part(temperature)
    part = part[np.isfinite(part)]
    if part.size == 0:
        return []
    tenth = max(1, part.size // 10)
    first, last = float(np.mean(part[:tenth])), float(np.mean(part[-tenth:]))
    text = f"the temperature goes from {first:.1f} to {last:.1f} °C within the steady part"
    return graded("temperature_drift", abs(last - first), *TEMPERATURE, text)


def _white(deviations: Float[np.ndarray, "cycle phase"]) -> float:
    """Noise of one grid value, from differences of neighbours (drift cancels)."""
    step = np.diff(deviations, axis=1)
    return float(1.4826 * np.median(np.abs(step - np.median(step))) / np.sqrt(2.0))
