"""The laboratory's temperature-dependent damper: BS09 Table 1, apart from `sysid.models`.

It shares no code and no numerical method with the model that is fitted to its data, so that an
error in either shows as a difference between them.
"""

from dataclasses import dataclass
from typing import Final

from sysid.rig.elementary import log10

CURRENTS: Final = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""A."""
VISCOSITY: Final = (
    (1400.0, -6.78), (1265.0, -7.07), (1451.0, -8.11), (1616.0, -8.74), (1734.0, -8.91),
    (1824.0, -9.43),
)  # fmt: skip
"""Of each current: C_post at 0 °C, N·s/m, and its change per kelvin (Table 1)."""
YIELD_FORCE: Final = (
    (41.0, 0.19), (331.0, -0.53), (766.0, -1.87), (1178.0, -3.47), (1481.0, -5.26),
    (1667.0, -6.42),
)  # fmt: skip
"""Of each current: F_y at 0 °C, N, and its change per kelvin (Table 1)."""
_FREEZING: Final = 273.15


@dataclass(frozen=True)
class Element:
    """A damper at one current and temperature: N/m, kg, N·s/m, N·s/m, N, and the gas force N."""

    stiffness: float
    mass: float
    pre_yield: float
    post_yield: float
    yield_force: float
    gas_force: float


@dataclass(frozen=True)
class FluidMemory:
    """A fluid whose structure remembers, over so many decades of time that none stands out.

    Broken structure rebuilds on all scales of time alike.  In faster motion a larger share of it
    has no time to yield, the same share for each decade of the motion's frequency: viscosity and
    yield force rise with the logarithm of frequency, at equal speed.

    Attributes:
        viscosity: Share by which C_post rises from decade to decade.
        yield_force: Share by which F_y does.
        frequency: At which Table 1 holds, Hz.
    """

    viscosity: float
    yield_force: float
    frequency: float

    def factors(self, frequency: float) -> tuple[float, float]:
        """What C_post and F_y are to be multiplied by at a frequency, Hz."""
        decades = log10(frequency / self.frequency)
        return 1.0 + self.viscosity * decades, 1.0 + self.yield_force * decades


@dataclass(frozen=True)
class LumpedDamper:
    """A bi-viscous element and a mass in series with a spring.

    Attributes:
        mass: m_l, kg.
        pre_yield: C_pre, N·s/m.
        stiffness: k at 0 °C, N/m.
        stiffness_per_kelvin: N/m/K.
        gas_force: Of the accumulator on the rod at 15 °C, N; it goes with absolute temperature,
            since the gas hardly changes its volume.
        memory: Of the fluid; None for a fluid whose laws do not depend on frequency.

    Source:
        BS09 Fig. 4 and Table 1, with the intercept of k in kN/m (printed kN).  The force is that
        on the piston's side; the paper has no gas force in its model but sees one.
    """

    mass: float = 2.0
    pre_yield: float = 1.0e5
    stiffness: float = 1.5e6
    stiffness_per_kelvin: float = 1.5e5
    gas_force: float = 60.0
    memory: FluidMemory | None = None

    def symbols(self) -> dict[str, float]:
        """Every number of the damper but its memory, named as model cards name them, SI and °C."""
        told = {
            "m_l": self.mass,
            "C_pre": self.pre_yield,
            "k.intercept": self.stiffness,
            "k.slope": self.stiffness_per_kelvin,
            "gas_force": self.gas_force,
        }
        for name, table in (("C_post", VISCOSITY), ("F_y", YIELD_FORCE)):
            for current, (start, slope) in zip(CURRENTS, table, strict=True):
                told[f"{name}[{current:g} A].intercept"] = start
                told[f"{name}[{current:g} A].slope"] = slope
        return told

    def element(self, current: float, temperature: float, frequency: float) -> Element:
        """The element in a test.

        Args:
            current: A, from 0; beyond 1 A the last line between two currents of Table 1 goes on.
            temperature: °C.
            frequency: Of the motion, Hz.
        """
        viscosity, yielding = 1.0, 1.0
        if self.memory is not None:
            viscosity, yielding = self.memory.factors(frequency)
        return Element(
            stiffness=self.stiffness + self.stiffness_per_kelvin * temperature,
            mass=self.mass,
            pre_yield=self.pre_yield,
            post_yield=viscosity * _read(VISCOSITY, current, temperature),
            yield_force=yielding * _read(YIELD_FORCE, current, temperature),
            gas_force=self.gas_force * ((temperature + _FREEZING) / (15.0 + _FREEZING)),
        )


def _read(table: tuple[tuple[float, float], ...], current: float, temperature: float) -> float:
    """Straight in temperature, and in current between two rows."""
    row = 0
    while row < len(CURRENTS) - 2 and current >= CURRENTS[row + 1]:
        row += 1
    low, high = (start + slope * temperature for start, slope in table[row : row + 2])
    return low + (high - low) * (current - CURRENTS[row]) / (CURRENTS[row + 1] - CURRENTS[row])
