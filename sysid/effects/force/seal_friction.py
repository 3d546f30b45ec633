"""Coulomb friction of the seal."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.smooth_sign import smooth_sign
from sysid.motion.motion import Motion
from sysid.parameters import param


class SealFriction(AbstractForceEffect):
    r"""A constant force against the motion.

        F = F_c sgn_s(v),   sgn_s(v) = tanh(v / 0.3 mm/s)

    Source:
        Rod seals of mono-tube dampers, 20–60 N.
    """

    facts: ClassVar[Facts] = Facts(
        id="seal_friction",
        family="friction",
        found_from="loops",
        size="F_c",
        nominal={"F_c": 40.0},
        realistic={"F_c": (20.0, 60.0)},
        parity=("OD", 1.0),
        exponents=(0.0, 0.0, 0.0),
        rivals=("stribeck_friction", "presliding_friction", "bypass_leakage"),
        separating_test="0.1 Hz at 0 A, with several pressures on the rod seal",
        source="rod seals, 20–60 N",
    )
    F_c: Scalar = param(symbol="F_c", name="Coulomb friction", unit="N", typical=40.0, low=0.0)

    def force(self, motion: Motion) -> Force:
        """Friction."""
        return self.F_c * smooth_sign(motion.velocity)
