"""The magnetorheological fluid: viscosity, yield stress, compressibility with air in it.

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from sysid.rig.physical.constant import Constant
from sysid.rig.physical.gas import ATMOSPHERE, FREEZING


class Oil(eqx.Module):
    """A suspension of iron in oil.

    Attributes:
        solids: Share of iron by volume.
        consistency: K of Herschel and Bulkley at 40 °C, Pa·sⁿ.
        exponent: n.
        slowest_shear: γ̇ below which the fluid thins no more, 1/s.
        activation: E/R of Andrade's law for K, K.
        yield_loss: Share of the yield stress lost per kelvin above 40 °C, 1/K.
        density: kg/m³.
        bulk_modulus: Without air, Pa.
        expansion: Of the volume, 1/K.
        air: Free air at atmospheric pressure, share of the volume.
    """

    solids: Constant
    consistency: Constant
    exponent: Constant
    slowest_shear: Constant
    activation: Constant
    yield_loss: Constant
    density: Constant
    bulk_modulus: Constant
    expansion: Constant
    air: Constant

    def thickness(self, temperature: Array) -> Array:
        """K at a temperature, °C: Andrade's exponential of the inverse absolute temperature."""
        inverse = 1.0 / (temperature + FREEZING) - 1.0 / (40.0 + FREEZING)
        return self.consistency * jnp.exp(self.activation * inverse)

    def yielding(self, stress: Array, temperature: Array) -> Array:
        """Yield stress, Pa, from that at 40 °C in the same field; falls as a straight line."""
        return stress * (1.0 - self.yield_loss * (temperature - 40.0))

    def compressibility(self, pressure: Array, more_air: Array) -> Array:
        """1/β of fluid and isothermal bubbles, 1/Pa.

        1/β = 1/β_oil + α p_0/p²,  where α is the share of air at the pressure p_0.

        Args:
            pressure: Absolute, Pa.
            more_air: Free gas besides what is always there, share at atmospheric pressure.
        """
        return 1.0 / self.bulk_modulus + (self.air + more_air) * ATMOSPHERE / pressure**2
