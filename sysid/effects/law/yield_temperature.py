"""Yield force that falls with temperature."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.effects.reference_temperature import excess_temperature
from sysid.motion.motion import Motion
from sysid.parameters import param


class YieldTemperature(AbstractLawEffect):
    r"""A factor on the yield part.

        F_yield ← F_yield (1 + β_y (T − 40 °C))

    Nothing where the temperature is not known.

    Source:
        BS09 Table 1 (F_y, about −0.3 % per kelvin).
    """

    facts: ClassVar[Facts] = Facts(
        id="yield_temperature",
        family="thermal",
        found_from="loops",
        size="beta_y",
        nominal={"beta_y": -0.003},
        realistic={"beta_y": (-0.006, -0.001)},
        parity=("OD", 0.9),
        exponents=(0.42, 0.4, 0.59),
        rivals=("viscosity_temperature", "run_drift"),
        separating_test="temperature and current varied independently",
        source="BS09 Table 1",
        of_temperature=True,
    )
    beta_y: Scalar = param(
        symbol="beta_y",
        name="relative change of the yield force per kelvin",
        unit="1/K",
        typical=0.003,
    )

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts at the temperature of the test."""
        factor = 1.0 + self.beta_y * excess_temperature(motion)
        return valve.changed(motion, Changes(yielding=factor))
