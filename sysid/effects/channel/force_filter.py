"""Low-pass filter of the force channel."""

from typing import ClassVar, Literal

import equinox as eqx

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.effects.causal import lagged, lagged_twice
from sysid.motion.motion import Motion
from sysid.parameters import param


class ForceFilter(AbstractChannelEffect):
    r"""A low-pass on the force alone: one pole (an RC circuit), or two (Butterworth).

    Exact for the harmonics of a cycle; elsewhere the exact answer to a force that is straight
    between samples and keeps its first value before the first.

        one pole   G(s) = 1 / (1 + s τ_c)
        two poles  G(s) = 1 / (1 + √2 s τ_c + s² τ_c²)

    The second delays by √2 τ_c what it hardly weakens: below its corner it looks like a delay.

    Attributes:
        poles: "one" or "two".

    Source:
        Signal conditioners and anti-alias filters with corners at 50–500 Hz; S. Butterworth,
        Experimental Wireless and the Wireless Engineer 7 (1930) 536.
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
        separating_test=(
            "2.5 mm, 15 Hz, 0.4 A; a rigid link in place of the damper; a current step: a filter "
            "rounds its corners"
        ),
        source="signal conditioners, 50–500 Hz",
    )
    tau_c: Scalar = param(
        symbol="tau_c", name="time constant of the force channel", unit="s", typical=0.001, low=0.0
    )

    poles: Literal["one", "two"] = eqx.field(default="one", static=True)

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force behind the filter."""
        lag = lagged if self.poles == "one" else lagged_twice
        return lag(force, motion, self.tau_c)
