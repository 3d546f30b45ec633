"""A sweep over temperature: one warm damper, test after test, as its oil heats and cools."""

from dataclasses import dataclass, field
from itertools import product
from typing import Final

from sysid.rig.bench import Bench, Plan
from sysid.rig.lumped_damper import LumpedDamper
from sysid.rig.lumped_run import Heat


@dataclass(frozen=True)
class WarmSetting:
    """What the operator asks for.

    Attributes:
        amplitude: m.
        frequency: Hz.
        current: A.
        temperature: At which the test is to start, °C.
        rate: Sampling rate, Hz; so that time has at most four decimals.
        plan: Rest, ramps, cycles.
        mark: What the file's name says at its end, if anything.
        wanders: Whether the test leaves its temperature so far behind that no label tells it.
    """

    amplitude: float
    frequency: float
    current: float
    temperature: float
    rate: int
    plan: Plan
    mark: str = ""
    wanders: bool = False

    @property
    def name(self) -> str:
        """Stem of the test's file, such as ``10mm_8Hz_0.4A_15C``."""
        words = [f"{1e3 * self.amplitude:g}mm", f"{self.frequency:g}Hz", f"{self.current:g}A"]
        words += [f"{self.temperature:g}C"] * (not self.wanders) + [self.mark] * bool(self.mark)
        return "_".join(words)


@dataclass(frozen=True)
class Operator:
    """How the tests of a sweep follow each other.

    Between two tests the damper rests and goes towards the temperature of the room.  If it is then
    further than the tolerance from where the next test is to start, it is worked or cooled until
    it is about there.

    Attributes:
        pause: s.
        tolerance: K.
        scatter: Standard deviation about the wanted temperature, K.
    """

    pause: float = 20.0
    tolerance: float = 2.0
    scatter: float = 0.8


@dataclass(frozen=True)
class Sweep:
    """A virtual campaign over temperature, complete but for its random numbers.

    Attributes:
        id: Name on the command line, and of the dataset's folder.
        title: Name of the campaign.
        about: What the damper and the design are, for the dataset's page; no parameter values.
        damper: Its physics.
        settings: The tests; those of one excitation and temperature are run in random order, the
            groups in the order of the design.
        seed: Of the random numbers.
        heat: Heat balance and thermometer.
        operator: What happens between tests.
        thermometer_sd: Error of the thermometer, one for each test, K.
        bench: Imperfections of the rig.
    """

    id: str
    title: str
    about: str
    damper: LumpedDamper
    settings: tuple[WarmSetting, ...]
    seed: int
    heat: Heat = field(default_factory=Heat)
    operator: Operator = field(default_factory=Operator)
    thermometer_sd: float = 0.3
    bench: Bench = field(default_factory=Bench)


SHORT_TEST: Final = Plan(rest=0.04, ramp_up=0.5, steady=3.5, ramp_down=0.5)
"""Three whole steady cycles, with half a cycle to spare."""
RATES: Final = {8.0: 1250, 4.0: 1000, 2.0: 1000}
"""Hz → samples a second: 156.25, 250 and 500 a cycle; the fluid's mass rings at up to 400 Hz."""


def warm_factorial(
    excitations: tuple[tuple[float, float], ...],
    temperatures: tuple[float, ...],
    currents: tuple[float, ...],
    mark: str = "",
) -> tuple[WarmSetting, ...]:
    """Every combination of excitations (m, Hz), temperatures (°C) and currents (A)."""
    return tuple(
        WarmSetting(amplitude, frequency, current, temperature, RATES[frequency], SHORT_TEST, mark)
        for (amplitude, frequency), temperature, current in product(
            excitations, temperatures, currents
        )
    )
