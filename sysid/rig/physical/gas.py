"""The gas behind the floating piston: ideal, and it exchanges heat with the wall.

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

from typing import Final

import equinox as eqx
from jax import Array

from sysid.rig.physical.constant import Constant

KAPPA: Final = 1.4
"""c_p/c_v of nitrogen, a diatomic gas."""
ATMOSPHERE: Final = 101_325.0
"""Pa; standard atmosphere."""
FREEZING: Final = 273.15
"""K; 0 °C."""


class Accumulator(eqx.Module):
    """A gas chamber closed by a piston or a diaphragm.

    Attributes:
        charge: Absolute pressure at mid-stroke and 20 °C, Pa.
        volume: The same, m³.
        heat_time: Of the gas's heat exchange with the wall, s.  Slow strokes are isothermal, fast
            ones adiabatic; between, the exponent of the polytrope follows from it.
    """

    charge: Constant
    volume: Constant
    heat_time: Constant

    def pressure(self, volume: Array, temperature: Array) -> Array:
        """Absolute, Pa, of an ideal gas at a volume, m³, and temperature, °C."""
        warmth = (temperature + FREEZING) / (20.0 + FREEZING)
        return self.charge * (self.volume / volume) * warmth

    def heat_capacity(self) -> Constant:
        """M c_v, J/K."""
        return self.charge * self.volume / ((20.0 + FREEZING) * (KAPPA - 1.0))

    def warming(self, volume: Array, rate: Array, temperature: Array, wall: Array) -> Array:
        """dT/dt of the gas, K/s: work done on it, and heat from the wall.

        Ṫ = −(κ − 1) T V̇/V + (T_wall − T)/τ

        Args:
            volume: m³.
            rate: V̇, m³/s.
            temperature: Of the gas, °C.
            wall: °C.
        """
        work = -(KAPPA - 1.0) * (temperature + FREEZING) * rate / volume
        return work + (wall - temperature) / self.heat_time
