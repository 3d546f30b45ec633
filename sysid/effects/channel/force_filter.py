"""Low-pass filter of the force channel."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.effects.causal import lagged
from sysid.motion.motion import Motion
from sysid.parameters import param


class ForceFilter(AbstractChannelEffect):
    r"""A first-order low-pass on the force alone.

    Exact for the harmonics of a cycle; elsewhere the exact answer to a force that is straight
    between samples and keeps its first value before the first.

        G(s) = 1 / (1 + s τ_c)

    Source:
        Signal conditioners and anti-alias filters with corners at 50–500 Hz.
    """

    facts: ClassVar[Facts] = Facts(
        id="force_filter",
        family="timing",
        found_from="loops",
        size="tau_c",
        nominal={"tau_c": 0.001},
        realistic={"tau_c": (0.0003, 0.003)},
        parity=("OC", 0.71),
        exponents=(0.46, 1.42, 0.39),
        rivals=("force_delay", "series_compliance"),
        separating_test="as for force_delay, and a current step: a filter rounds the corners",
        source="signal conditioners, 50–500 Hz",
    )
    tau_c: Scalar = param(
        symbol="tau_c", name="time constant of the force channel", unit="s", typical=0.001, low=0.0
    )

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force behind the filter."""
        return lagged(force, motion, self.tau_c)
