"""Friction that builds up over a short travel."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.bristle import bent
from sysid.motion.motion import Motion
from sysid.parameters import param


class PreslidingFriction(AbstractForceEffect):
    r"""A bristle that bends before it slides: rate-independent hysteresis after every reversal.

        dF/dx = σ_0 (1 − F sgn(v) / F_ps),   steady: F = F_ps sgn(v)

    Source:
        P. R. Dahl (1968), which is LuGre (C. Canudas de Wit et al., IEEE TAC 40, 1995) without
        Stribeck and micro-damping; σ_0 = 10⁵–10⁶ N/m.
    """

    facts: ClassVar[Facts] = Facts(
        id="presliding_friction",
        family="friction",
        found_from="loops",
        size="F_ps",
        nominal={"F_ps": 40.0, "sigma_0": 300000.0},
        realistic={"F_ps": (10.0, 80.0), "sigma_0": (100000.0, 1000000.0)},
        parity=("OD", 0.93),
        exponents=(0.0, 0.0, 0.0),
        rivals=("seal_friction", "series_compliance"),
        separating_test="reversals at small amplitude",
        source="Dahl 1968; Canudas de Wit et al. 1995",
        with_size=("sigma_0",),
    )
    F_ps: Scalar = param(
        symbol="F_ps", name="friction when sliding", unit="N", typical=40.0, low=0.0
    )
    sigma_0: Scalar = param(
        symbol="sigma_0",
        name="stiffness before sliding",
        unit="N/m",
        typical=300000.0,
        low=0.0,
        scale="log",
    )

    def force(self, motion: Motion) -> Force:
        """Friction."""
        return self.F_ps * bent(motion, self.F_ps / self.sigma_0)
