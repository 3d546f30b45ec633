"""Gain that differs between compression and rebound."""

from typing import ClassVar, Literal

import equinox as eqx
import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.effects.smooth_sign import smooth_sign
from sysid.motion.motion import Motion
from sysid.parameters import param


class AsymmetricGain(AbstractChannelEffect):
    r"""A gain error of opposite sign in the two directions, of the motion or of the force.

    Valves answer to where the rod goes, a load cell to whether it is pressed or pulled.  Between a
    reversal and the force's own zero the two differ.

        velocity   F_rec = F (1 + g_a sgn_s(v)),   sgn_s(v) = tanh(v / 0.3 mm/s)
        force      F_rec = F + g_a |F|

    Attributes:
        turns: With which sign the gain changes: that of the "velocity" or of the "force".

    Source:
        Check valves; load cells that differ in tension and compression, 1–5 %.
    """

    facts: ClassVar[Facts] = Facts(
        id="asymmetric_gain",
        family="offset",
        found_from="loops",
        size="g_a",
        nominal={"g_a": 0.03},
        realistic={"g_a": (-0.05, 0.05)},
        parity=("EC", 0.94),
        exponents=(0.43, 0.4, 0.39),
        rivals=("force_offset", "entrained_air"),
        separating_test="two currents: the asymmetry grows with the force, an offset does not",
        source="check valves; load cells in tension and compression",
    )
    g_a: Scalar = param(symbol="g_a", name="asymmetric gain", unit="-", typical=0.03)

    turns: Literal["velocity", "force"] = eqx.field(default="velocity", static=True)

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force with a gain of its own in each direction."""
        if self.turns == "force":
            return force + self.g_a * jnp.abs(force)
        return force * (1.0 + self.g_a * smooth_sign(motion.velocity))
