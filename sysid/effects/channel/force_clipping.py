"""Limit of the force channel's range."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class ForceClipping(AbstractChannelEffect):
    r"""The recorded force stops at a limit 1/q_F on both sides.

        F_rec = F / max(1, q_F |F|)

    Source:
        Range of an analogue-digital converter or of a conditioner.
    """

    facts: ClassVar[Facts] = Facts(
        id="force_clipping",
        family="acquisition",
        found_from="loops",
        size="q_F",
        nominal={"q_F": 0.0007},
        realistic={"q_F": (1e-05, 0.01)},
        parity=("OD", 0.95),
        exponents=None,
        rivals=("current_saturation", "eddy_loss"),
        separating_test="another measuring range",
        source="range of the converter",
    )
    q_F: Scalar = param(
        symbol="q_F", name="inverse limit of the force", unit="1/N", typical=0.0007, low=0.0
    )

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force inside the range."""
        return force / jnp.maximum(1.0, self.q_F * jnp.abs(force))
