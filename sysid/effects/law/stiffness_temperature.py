"""Loop width that falls as the fluid stiffens with temperature."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.effects.reference_temperature import excess_temperature
from sysid.motion.motion import Motion
from sysid.parameters import param


class StiffnessTemperature(AbstractLawEffect):
    r"""Stiffness that grows with temperature makes the loop narrower.

        v_h ← v_h / (1 + β_k (T − 40 °C)),   k ← k (1 + β_k (T − 40 °C))

    A valve with a spring of its own (`Lumped`) has k; of any other, the width v_h is what its sign
    of acceleration is multiplied by.  The factor is kept above 0.1.  Nothing where the temperature
    is not known, and nothing with a valve that has no such spring and whose hysteresis does not
    follow the sign of acceleration.

    Source:
        BS09 Table 1: k = 1500 + 150 T kN/m, that is β_k = 0.02 per kelvin at 40 °C.  Of other
        dampers it may fall: oil and rubber soften as they warm.
    """

    facts: ClassVar[Facts] = Facts(
        id="stiffness_temperature",
        family="thermal",
        found_from="loops",
        size="beta_k",
        nominal={"beta_k": 0.02},
        realistic={"beta_k": (-0.03, 0.03)},
        parity=("OC", 0.66),
        exponents=(0.45, 0.41, 0.65),
        rivals=("series_compliance",),
        separating_test="sweep the temperature at high current",
        source="BS09 Table 1",
        of_temperature=True,
    )
    beta_k: Scalar = param(
        symbol="beta_k", name="relative change of stiffness per kelvin", unit="1/K", typical=0.02
    )

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts with the width at the temperature of the test."""
        factor = jnp.maximum(1.0 + self.beta_k * excess_temperature(motion), 0.1)
        return valve.changed(motion, Changes(stiffness=factor))
