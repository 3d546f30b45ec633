"""Friction of rod guide and piston that grows as the rod comes out."""

from typing import ClassVar, Final

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.smooth_sign import smooth_sign
from sysid.motion.motion import Motion
from sysid.parameters import param

SHORTEST: Final = 0.05
"""Parts of the guide distance at the centre below which it does not fall: a piston has a length."""


class GuideFriction(AbstractForceEffect):
    r"""A rod under side load: the nearer its two guides, the harder they are pressed.

        F = F_g (1 / (1 + x/l_g) − 1) sgn_s(v),   sgn_s(v) = tanh(v / 0.3 mm/s)

    Moments about the piston balance a side load S at the end of a rod that stands out by a:
    guide and piston press with S (a + l)/l and S a/l, l the distance between them.  a + l is the
    length of the rod, so friction is that length over l, up to a constant, and l = l_g + x since
    the rod goes in while x grows.  F_g and l_g are values at the centre; what does not change along
    the stroke is seal friction.  Large l_g make it friction in proportion to x.

    Source:
        Balance of moments.  That the load on the guides, at any point of the stroke, is a function
        of the radial load and the distance between rod and piston guides: SKF, Hydraulic seals,
        Guide rings and guide strips, Guide distance.  Range of F_g and l_g: judgement.
    """

    facts: ClassVar[Facts] = Facts(
        id="guide_friction",
        family="friction",
        found_from="loops",
        size="F_g",
        nominal={"F_g": 15.0, "l_g": 0.1},
        realistic={"F_g": (3.0, 60.0), "l_g": (0.08, 0.3)},
        parity=None,
        exponents=None,
        rivals=("position_friction", "seal_friction", "bump_stop"),
        separating_test=(
            "the same amplitude about another centre: with the rod further in it must fall; turn "
            "the rod by 90 degrees"
        ),
        source="balance of moments on a side-loaded rod; SKF, Hydraulic seals, Guide distance",
    )
    F_g: Scalar = param(
        symbol="F_g", name="guide friction at the centre", unit="N", typical=15.0, low=0.0
    )
    l_g: Scalar = param(
        symbol="l_g", name="distance between the guides at the centre", unit="m", low=0.0,
        typical=0.1, scale="log",
    )  # fmt: skip

    def force(self, motion: Motion) -> Force:
        """Friction beyond that at the centre."""
        distance = jnp.maximum(self.l_g, 1e-9)
        share = jnp.maximum(1.0 + motion.displacement / distance, SHORTEST)
        return self.F_g * (1.0 / share - 1.0) * smooth_sign(motion.velocity)
