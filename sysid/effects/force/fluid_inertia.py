"""Inertia of the fluid in parallel to the valve."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class FluidInertia(AbstractForceEffect):
    r"""The fluid that the piston accelerates through the gap.

        F = m_f a

    Source:
        Fluid mass times the squared ratio of piston to gap area; 0.5–3 kg (BS09: 2 kg in series).
    """

    facts: ClassVar[Facts] = Facts(
        id="fluid_inertia",
        family="reactive",
        found_from="loops",
        size="m_f",
        nominal={"m_f": 1.5},
        realistic={"m_f": (0.5, 3.0)},
        parity=("OC", 1.0),
        exponents=(1.0, 2.0, 0.0),
        rivals=("fixture_inertia", "gas_spring", "force_delay"),
        separating_test=(
            "high frequency, small amplitude, 0 A; for the fixture's share, run the rig without "
            "the damper"
        ),
        source="BS09 Table 1 (m_l = 2 kg)",
    )
    m_f: Scalar = param(symbol="m_f", name="apparent mass of the fluid", unit="kg", typical=1.5)

    def force(self, motion: Motion) -> Force:
        """Force of inertia."""
        return self.m_f * motion.acceleration
