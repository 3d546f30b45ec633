"""Friction that changes along the stroke."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.smooth_sign import smooth_sign
from sysid.motion.motion import Motion
from sysid.parameters import param


class PositionFriction(AbstractForceEffect):
    r"""Side load or a bore that is not straight.

        F = c_xf x sgn_s(v),   sgn_s(v) = tanh(v / 0.3 mm/s)

    Source:
        Side load on rod guides, 10–50 N over 50 mm.
    """

    facts: ClassVar[Facts] = Facts(
        id="position_friction",
        family="friction",
        found_from="loops",
        size="c_xf",
        nominal={"c_xf": 600.0},
        realistic={"c_xf": (-1000.0, 1000.0)},
        parity=("ED", 1.0),
        exponents=(1.0, 0.0, 0.0),
        rivals=(),
        separating_test="turn the rod by 90 degrees",
        source="side load on rod guides",
    )
    c_xf: Scalar = param(symbol="c_xf", name="friction per travel", unit="N/m", typical=600.0)

    def force(self, motion: Motion) -> Force:
        """Friction beyond that at the centre."""
        return self.c_xf * motion.displacement * smooth_sign(motion.velocity)
