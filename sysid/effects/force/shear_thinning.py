"""Viscous force of a shear-thinning fluid."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class ShearThinning(AbstractForceEffect):
    r"""A power law of speed, straight below v_0 = 1 mm/s so that it has a slope at rest.

        F = K_hb v (v² + v_0²)^((n_hb − 1)/2)  →  K_hb |v|^n_hb sgn v

    Source:
        W. H. Herschel, R. Bulkley (1926); n = 0.55–0.85, 50–300 N at 0.2 m/s.
    """

    facts: ClassVar[Facts] = Facts(
        id="shear_thinning",
        family="viscous",
        found_from="loops",
        size="K_hb",
        nominal={"K_hb": 500.0, "n_hb": 0.7},
        realistic={"K_hb": (150.0, 900.0), "n_hb": (0.55, 0.85)},
        parity=("OD", 1.0),
        exponents=(0.7, 0.7, 0.0),
        rivals=("linear_viscosity", "quadratic_loss"),
        separating_test="speeds over a range of 1:30 at 0 A",
        source="Herschel & Bulkley 1926",
    )
    K_hb: Scalar = param(symbol="K_hb", name="consistency", unit="N·(s/m)^n", typical=500.0)
    n_hb: Scalar = param(symbol="n_hb", name="flow index", unit="-", typical=0.7, low=0.0, high=1.0)

    def force(self, motion: Motion) -> Force:
        """Viscous force."""
        v = motion.velocity
        return self.K_hb * v * (v**2 + 1e-6) ** (0.5 * (self.n_hb - 1.0))
