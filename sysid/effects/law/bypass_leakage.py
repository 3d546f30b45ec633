"""Leakage past the valve under its own pressure."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Facts, Parts, ValveParts
from sysid.effects.leak import parts_beside_leak
from sysid.motion.motion import Motion
from sysid.parameters import param


class BypassLeakage(AbstractLawEffect):
    r"""Part of the flow leaks past the piston in proportion to the force, at every instant.

        v_eff = v − k_l F(v_eff)

    Source:
        Laminar leakage past a piston ring, 10⁻⁷–3·10⁻⁶ (m/s)/N.  Flow before the fluid yields is of
        the same form: 1/C_pre, 10⁻⁵ (m/s)/N in BS09 (C_pre = 100 kN·s/m).
    """

    facts: ClassVar[Facts] = Facts(
        id="bypass_leakage",
        family="friction",
        found_from="loops",
        size="k_l",
        nominal={"k_l": 1.0e-6},
        realistic={"k_l": (1.0e-7, 1.0e-5)},
        parity=("OD", 0.67),
        exponents=(-0.17, -0.21, 0.8),
        rivals=("seal_friction", "series_compliance"),
        separating_test="hold a constant load and watch the piston creep",
        source="laminar leakage past a piston ring; BS09, C_pre",
    )
    k_l: Scalar = param(
        symbol="k_l", name="leakage per force", unit="m/(s·N)", low=0.0, typical=1.0e-6
    )

    def leakage(self, motion: Motion) -> Scalar:
        """k, the same at every instant."""
        return self.k_l

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts at the speed that does not leak."""
        return parts_beside_leak(motion, valve, self.leakage(motion))
