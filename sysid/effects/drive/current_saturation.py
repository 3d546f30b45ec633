"""Limit of the current."""

from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import AbstractDriveEffect, Facts
from sysid.motion.motion import Motion
from sysid.parameters import param


class CurrentSaturation(AbstractDriveEffect):
    r"""The amplifier or the core limits the effective current to i_s = 1/q_s.

    The current law of a base model absorbs it.

        i_eff = tanh(q_s i) / q_s

    Source:
        Amplifiers and saturation of the core, i_s = 0.4–1.2 A.
    """

    facts: ClassVar[Facts] = Facts(
        id="current_saturation",
        family="current_law",
        found_from="invisible",
        size="q_s",
        nominal={"q_s": 1.5},
        realistic={"q_s": (0.8, 2.5)},
        parity=("OD", 0.81),
        exponents=(0.42, 0.4, 1.75),
        rivals=("force_clipping",),
        separating_test="measure the current in the coil",
        source="amplifier limit; saturation of the core",
    )
    q_s: Scalar = param(
        symbol="q_s", name="inverse saturation current", unit="1/A", typical=1.5, low=0.0
    )

    def current(self, motion: Motion) -> Float[Array, "*batch c"]:
        """Current below its limit."""
        z = self.q_s * motion.current
        small = jnp.abs(z) < 1e-4
        safe = jnp.where(small, 1.0, z)
        return motion.current * jnp.where(small, 1.0 - z**2 / 3.0, jnp.tanh(safe) / safe)
