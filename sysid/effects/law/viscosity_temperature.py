"""Viscosity that falls with temperature."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.effects.reference_temperature import excess_temperature
from sysid.motion.motion import Motion
from sysid.parameters import param


class ViscosityTemperature(AbstractLawEffect):
    r"""A factor on the viscous part.

        F_visc ← F_visc exp(β_v (T − 40 °C))

    Nothing where the temperature is not known.

    Source:
        BS09 Table 1 (C_post, −0.6 to −0.7 % per kelvin at 40 °C); Arrhenius law near 40 °C.
    """

    facts: ClassVar[Facts] = Facts(
        id="viscosity_temperature",
        family="thermal",
        found_from="loops",
        size="beta_v",
        nominal={"beta_v": -0.005},
        realistic={"beta_v": (-0.01, -0.002)},
        parity=("OD", 0.98),
        exponents=(0.42, 0.4, 0.0),
        rivals=("yield_temperature", "run_drift"),
        separating_test="temperature and current varied independently",
        source="BS09 Table 1",
        of_temperature=True,
    )
    beta_v: Scalar = param(
        symbol="beta_v", name="relative change of viscosity per kelvin", unit="1/K", typical=0.005
    )

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts at the temperature of the test."""
        factor = jnp.exp(self.beta_v * excess_temperature(motion))
        return valve.changed(motion, Changes(viscous=factor))
