"""Linear gas spring."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class GasSpring(AbstractForceEffect):
    r"""The accumulator's stiffness at the centre of the stroke.

        F = k_g x,   k_g = n P_0 A_r² / V_0

    Source:
        Polytropic gas in a mono-tube accumulator, linearised; 0.5–4 kN/m.
    """

    facts: ClassVar[Facts] = Facts(
        id="gas_spring",
        family="reactive",
        found_from="loops",
        size="k_g",
        nominal={"k_g": 1500.0},
        realistic={"k_g": (500.0, 4000.0)},
        parity=("OC", 1.0),
        exponents=(1.0, 0.0, 0.0),
        rivals=("fluid_inertia", "fixture_inertia", "bump_stop"),
        separating_test="a large amplitude at 0.1 Hz and 0 A; two frequencies at one amplitude",
        source="polytropic gas, linearised",
    )
    k_g: Scalar = param(symbol="k_g", name="stiffness of the gas", unit="N/m", typical=1500.0)

    def force(self, motion: Motion) -> Force:
        """Force of the gas."""
        return self.k_g * motion.displacement
