"""Hum of the mains on the force."""

from typing import ClassVar

import equinox as eqx
import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class MainsHum(AbstractChannelEffect):
    r"""A sinusoid of the mains frequency.

    It keeps no phase with the motion, so a mean over cycles loses it and it shows in the spread
    between cycles.

        F_rec = F + h_m sin(2π f_mains t)

    Attributes:
        mains: Mains frequency, Hz.

    Source:
        Ground loops, 1–5 N at 50 or 60 Hz.
    """

    facts: ClassVar[Facts] = Facts(
        id="mains_hum",
        family="acquisition",
        found_from="check",
        size="h_m",
        nominal={"h_m": 2.0},
        realistic={"h_m": (1.0, 5.0)},
        parity=None,
        exponents=None,
        rivals=(),
        separating_test="a record at rest",
        source="ground loops",
    )
    h_m: Scalar = param(symbol="h_m", name="amplitude of the hum", unit="N", typical=2.0)
    mains: float = eqx.field(default=50.0, static=True)

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force with the hum."""
        return force + self.h_m * jnp.sin(2.0 * jnp.pi * self.mains * motion.time)
