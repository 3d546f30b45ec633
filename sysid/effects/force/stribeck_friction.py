"""Friction that falls with speed at low speed."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.bristle import bent
from sysid.motion.motion import Motion
from sysid.parameters import param


class StribeckFriction(AbstractForceEffect):
    r"""What friction at rest has more than friction in motion.

        F = F_s exp(−(v / v_st)²) y,   dy/|dx| = (sgn v − y) σ_0 / F_s

    A seal does not let go where the motion stops: there it holds with all its force against the
    motion that was, and turns over while the rod goes the first F_s/σ_0 back.  With sgn v in the
    place of y the force would be zero at every reversal, which is where most of it is.

    Source:
        B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994);
        10–50 N, 2–20 mm/s.  Bristles: P. R. Dahl (1968); 3–300 µm at 30 N.
    """

    facts: ClassVar[Facts] = Facts(
        id="stribeck_friction",
        family="friction",
        found_from="loops",
        size="F_s",
        nominal={"F_s": 30.0, "v_st": 0.01, "sigma_0": 1e6},
        realistic={"F_s": (10.0, 50.0), "v_st": (0.002, 0.02), "sigma_0": (1e5, 1e7)},
        parity=("OD", 0.73),
        exponents=None,
        rivals=("seal_friction", "presliding_friction"),
        separating_test="a triangular motion at several constant low speeds",
        source="Armstrong-Hélouvry et al. 1994; Dahl 1968",
        with_size=("sigma_0",),
    )
    F_s: Scalar = param(symbol="F_s", name="Stribeck friction", unit="N", typical=30.0, low=0.0)
    v_st: Scalar = param(
        symbol="v_st", name="Stribeck speed", unit="m/s", typical=0.01, low=0.0, scale="log"
    )
    sigma_0: Scalar = param(
        symbol="sigma_0",
        name="stiffness before sliding",
        unit="N/m",
        typical=1e6,
        low=0.0,
        scale="log",
    )

    def force(self, motion: Motion) -> Force:
        """Friction."""
        v = motion.velocity
        return self.F_s * jnp.exp(-((v / self.v_st) ** 2)) * bent(motion, self.F_s / self.sigma_0)
