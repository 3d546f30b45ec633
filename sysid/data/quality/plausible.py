"""Numbers that no damper rig gives: a unit is not what header or manifest say."""

from typing import Final

import numpy as np

from sysid.data.figures import ampere, figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.subject import Subject

LARGEST: Final = 2.0
"""m: twice the stroke of the largest dampers of buildings and bridges."""
SMALLEST: Final = 0.05e-3
"""m, of an amplitude: the play in a rod's bearings; seals follow such motion without sliding."""
FASTEST: Final = 20.0
"""m/s: twice what drop towers and shock rigs reach."""
SLOWEST: Final = 0.01
"""Hz: seals are tried at a tenth of a hertz, hardly ever at less than a hundredth."""
STRONGEST: Final = 1e8
"""N: ten times the largest dampers of buildings."""
CURRENT: Final = 50.0
"""A: ten times what coils of dampers take."""
TEMPERATURES: Final = (-60.0, 200.0)
"""°C, between which carrier oils are used."""
UNUSUAL: Final = 0.05
"""Part of a record's samples that may be beyond a limit: spikes tell no unit."""


def check_plausible(subject: Subject) -> list[Fault]:
    """Amplitude, speed and force of a steady test, current and temperature, against what rigs do.

    Only what is beyond any rig is told: dampers of 5 N and of 5 MN are built, so that kN taken for
    N cannot be seen.  Of a recorded channel the median counts for the temperature, and for the
    current what all but `UNUSUAL` of the samples stay below.
    """
    told = [*_motion(subject), *_current(subject), *_temperature(subject)]
    return [
        Fault("implausible", "warning", f"{text} Correct the unit in the header or the manifest")
        for text in told
    ]


def _motion(subject: Subject) -> list[str]:
    steady = subject.steady
    if steady is None:
        return []
    amplitude, speed = steady.amplitude, 2.0 * np.pi * steady.frequency * steady.amplitude
    told = []
    if amplitude > LARGEST or speed > FASTEST:
        told.append(
            f"an amplitude of {figure(amplitude, 3)} m at {figure(steady.frequency, 3)} Hz, so "
            f"{figure(speed, 3)} m/s, is beyond any rig: millimetres taken for metres, or "
            "milliseconds for seconds?"
        )
    if steady.frequency < SLOWEST:
        told.append(
            f"a cycle of {figure(1.0 / steady.frequency, 3)} s is slower than dampers are tested: "
            "milliseconds taken for seconds?"
        )
    if amplitude < SMALLEST:
        told.append(
            f"an amplitude of {figure(1e3 * amplitude, 3)} mm shows the play of bearings and "
            "seals, no damper: metres taken for millimetres?"
        )
    if subject.peak_force > STRONGEST:
        told.append(
            f"a force of {figure(1e-6 * subject.peak_force, 3)} MN is beyond any damper: N taken "
            "for kN?"
        )
    return told


def _current(subject: Subject) -> list[str]:
    record = subject.record
    current = record.nominal.current
    if record.current is not None and np.isfinite(record.current).all():
        current = float(np.quantile(np.abs(record.current), 1.0 - UNUSUAL))
    if current is None or abs(current) <= CURRENT:
        return []
    return [f"a current of {ampere(current)} is beyond any damper's coil: mA taken for A?"]


def _temperature(subject: Subject) -> list[str]:
    record = subject.record
    temperature = record.nominal.temperature
    if record.temperature is not None and np.isfinite(record.temperature).all():
        temperature = float(np.median(record.temperature))
    if temperature is None or TEMPERATURES[0] <= temperature <= TEMPERATURES[1]:
        return []
    taken = "°C taken for K" if temperature < 0.0 else "K or °F taken for °C"
    return [
        f"a temperature of {figure(temperature, 4)} °C is beyond any damper's oil: {taken}, or a "
        "sensor that is off?"
    ]
