"""Resolution of the force channel."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class ForceQuantization(AbstractChannelEffect):
    r"""The recorded force is a whole number of steps.

        F_rec = d_F round(F / d_F)

    Source:
        Resolution of an analogue-digital converter, 0.1–5 N.
    """

    facts: ClassVar[Facts] = Facts(
        id="force_quantization",
        family="acquisition",
        found_from="check",
        size="d_F",
        nominal={"d_F": 1.0},
        realistic={"d_F": (0.1, 5.0)},
        parity=None,
        exponents=None,
        rivals=(),
        separating_test="none is needed: the steps are seen in the record",
        source="resolution of the converter",
    )
    d_F: Scalar = param(
        symbol="d_F", name="step of the force channel", unit="N", typical=1.0, low=0.0
    )

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force on its steps."""
        step = jnp.where(self.d_F > 0.0, self.d_F, 1.0)
        return jnp.where(self.d_F > 0.0, step * jnp.round(force / step), force)
