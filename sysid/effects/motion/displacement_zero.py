"""Zero of the displacement."""

from collections.abc import Callable
from typing import ClassVar

import equinox as eqx
import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractMotionEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class DisplacementZero(AbstractMotionEffect):
    r"""The middle of the stroke is not where the record says.

        x_v = x + x_0,   off cycles also  v_m² ← max(v_m² − a x_0, 0)

    Only models and effects that depend on place see it, and W11 Eq. 10 away from steady cycles.

    Source:
        W11 Eq. 10; mean position of the actuator, 0.1–2 mm.
    """

    facts: ClassVar[Facts] = Facts(
        id="displacement_zero",
        family="offset",
        found_from="invisible",
        size="x_0",
        nominal={"x_0": 0.001},
        realistic={"x_0": (-0.002, 0.002)},
        parity=None,
        exponents=None,
        rivals=("force_offset",),
        separating_test="centre the actuator anew",
        source="W11 Eq. 10; mean position of the actuator",
    )
    x_0: Scalar = param(symbol="x_0", name="shift of the displacement", unit="m", typical=0.001)

    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion about the shifted centre."""
        shifted = eqx.tree_at(lambda m: m.displacement, motion, motion.displacement + self.x_0)
        if motion.periodic:
            return shifted
        square = motion.peak_velocity**2 - motion.acceleration * self.x_0
        moving = square > 0.0
        peak = jnp.where(moving, jnp.sqrt(jnp.where(moving, square, 1.0)), 0.0)
        return eqx.tree_at(lambda m: m.peak_velocity, shifted, peak)
