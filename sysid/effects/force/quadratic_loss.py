"""Entrance and turbulent loss."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class QuadraticLoss(AbstractForceEffect):
    r"""Pressure loss with the square of speed.

        F = c_2 v |v|

    Source:
        Entrance loss and turbulent flow in the gap; 50–400 N at 1 m/s.
    """

    facts: ClassVar[Facts] = Facts(
        id="quadratic_loss",
        family="viscous",
        found_from="loops",
        size="c_2",
        nominal={"c_2": 200.0},
        realistic={"c_2": (50.0, 400.0)},
        parity=("OD", 1.0),
        exponents=(2.0, 2.0, 0.0),
        rivals=("shear_thinning", "linear_viscosity"),
        separating_test="the highest speed at 0 A, at two temperatures",
        source="entrance and turbulent loss",
    )
    c_2: Scalar = param(symbol="c_2", name="quadratic loss", unit="N·s²/m²", typical=200.0)

    def force(self, motion: Motion) -> Force:
        """Loss."""
        return self.c_2 * motion.velocity * jnp.abs(motion.velocity)
