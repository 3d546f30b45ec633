"""Viscous force that the base lacks."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class LinearViscosity(AbstractForceEffect):
    r"""A force in proportion to speed.

        F = c_1 v

    Source:
        Poiseuille flow in an annular gap; 50–500 N·s/m.
    """

    facts: ClassVar[Facts] = Facts(
        id="linear_viscosity",
        family="viscous",
        found_from="loops",
        size="c_1",
        nominal={"c_1": 200.0},
        realistic={"c_1": (50.0, 500.0)},
        parity=("OD", 1.0),
        exponents=(1.0, 1.0, 0.0),
        rivals=("shear_thinning", "quadratic_loss"),
        separating_test="speeds over a range of 1:30 at 0 A",
        source="Poiseuille flow",
    )
    c_1: Scalar = param(symbol="c_1", name="linear viscosity", unit="N·s/m", typical=200.0)

    def force(self, motion: Motion) -> Force:
        """Viscous force."""
        return self.c_1 * motion.velocity
