"""Friction that falls with speed at low speed."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.smooth_sign import smooth_sign
from sysid.motion.motion import Motion
from sysid.parameters import param


class StribeckFriction(AbstractForceEffect):
    r"""What friction at rest has more than friction in motion.

        F = F_s exp(−(v / v_st)²) sgn_s(v),   sgn_s(v) = tanh(v / 0.3 mm/s)

    Source:
        B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994);
        10–50 N, 2–20 mm/s.
    """

    facts: ClassVar[Facts] = Facts(
        id="stribeck_friction",
        family="friction",
        found_from="loops",
        size="F_s",
        nominal={"F_s": 30.0, "v_st": 0.01},
        realistic={"F_s": (10.0, 50.0), "v_st": (0.002, 0.02)},
        parity=("OD", 1.0),
        exponents=None,
        rivals=("seal_friction", "presliding_friction"),
        separating_test="a triangular motion at several constant low speeds",
        source="Armstrong-Hélouvry et al. 1994",
    )
    F_s: Scalar = param(symbol="F_s", name="Stribeck friction", unit="N", typical=30.0, low=0.0)
    v_st: Scalar = param(
        symbol="v_st", name="Stribeck speed", unit="m/s", typical=0.01, low=0.0, scale="log"
    )

    def force(self, motion: Motion) -> Force:
        """Friction."""
        v = motion.velocity
        return self.F_s * jnp.exp(-((v / self.v_st) ** 2)) * smooth_sign(v)
