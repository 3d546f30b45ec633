"""Zero of the load cell, or static gas force."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class ForceOffset(AbstractChannelEffect):
    r"""A constant added to the recorded force.

        F_rec = F + F_off

    Source:
        Load-cell zero 3–20 N; gas preload P_0 A_r = 2 MPa × (0.8–1.1)·10⁻⁴ m² = 150–250 N.
    """

    facts: ClassVar[Facts] = Facts(
        id="force_offset",
        family="offset",
        found_from="loops",
        size="F_off",
        nominal={"F_off": 20.0},
        realistic={"F_off": (-250.0, 250.0)},
        parity=("EC", 1.0),
        exponents=(0.0, 0.0, 0.0),
        rivals=("gas_temperature", "asymmetric_gain"),
        separating_test="record the force with the rod disconnected, before and after",
        source="load-cell zero; gas preload",
    )
    F_off: Scalar = param(symbol="F_off", name="offset of the force", unit="N", typical=20.0)

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force with the offset."""
        return force + self.F_off
