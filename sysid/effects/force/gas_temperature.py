"""Gas pressure that follows temperature."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.reference_temperature import excess_temperature
from sysid.motion.motion import Motion
from sysid.parameters import param


class GasTemperature(AbstractForceEffect):
    r"""The gas preload grows with absolute temperature.

        F = c_gT (T − 40 °C),   c_gT = P_0 A_r / 313 K

    Nothing where the temperature is not known.

    Source:
        Ideal gas at constant volume, 0.5–0.7 N/K.  Negative where both channels are turned, or
        where it is the load cell whose zero drifts with temperature.
    """

    facts: ClassVar[Facts] = Facts(
        id="gas_temperature",
        family="offset",
        found_from="loops",
        size="c_gT",
        nominal={"c_gT": 0.6},
        realistic={"c_gT": (-1.0, 1.0)},
        parity=("EC", 1.0),
        exponents=(0.0, 0.0, 0.0),
        rivals=("force_offset",),
        separating_test=(
            "sweep the temperature, with zeros of the load cell taken with the rod disconnected"
        ),
        source="ideal gas at constant volume",
        of_temperature=True,
    )
    c_gT: Scalar = param(symbol="c_gT", name="gas force per kelvin", unit="N/K", typical=0.6)

    def force(self, motion: Motion) -> Force:
        """Force of the gas beyond that at 40 °C."""
        return self.c_gT * excess_temperature(motion) * jnp.ones_like(motion.displacement)
