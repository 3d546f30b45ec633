"""Delay of the force channel behind displacement."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.effects.causal import delayed
from sysid.motion.motion import Motion
from sysid.parameters import param


class ForceDelay(AbstractChannelEffect):
    r"""A pure delay, exact for the harmonics of a cycle, by interpolation elsewhere.

        F_rec(t) = F(t − τ_F)

    Source:
        Skew between DAQ channels and conditioners, 0.05–2 ms; of either sign, for the displacement
        may be the one that is late.
    """

    facts: ClassVar[Facts] = Facts(
        id="force_delay",
        family="timing",
        found_from="loops",
        size="tau_F",
        nominal={"tau_F": 0.0005},
        realistic={"tau_F": (-0.002, 0.002)},
        parity=("OC", 0.73),
        exponents=(0.46, 1.43, 0.39),
        rivals=("force_filter", "series_compliance", "velocity_delay"),
        separating_test="2.5 mm, 15 Hz, 0.4 A; a rigid link in place of the damper",
        source="skew between DAQ channels",
    )
    tau_F: Scalar = param(
        symbol="tau_F", name="delay of the force channel", unit="s", typical=0.0005
    )

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force as it was τ_F ago."""
        return delayed(force, motion, self.tau_F)
