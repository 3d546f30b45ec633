"""Friction that builds up over a short travel."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.first_order import first_order
from sysid.motion.motion import Motion
from sysid.parameters import param


class PreslidingFriction(AbstractForceEffect):
    r"""A bristle that bends before it slides: rate-independent hysteresis after every reversal.

        dF/dx = σ_0 (1 − F sgn(v) / F_ps),   steady: F = F_ps sgn(v)

    Solved exactly on every step between two samples, and in closed form for the state that repeats
    itself after a cycle; any other motion starts relaxed.

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
        x = motion.displacement
        moved = x - jnp.roll(x, 1, axis=-1)
        if not motion.periodic:
            moved = moved.at[..., 0].set(0.0)
        kept = jnp.exp(-self.sigma_0 * jnp.abs(moved) / jnp.maximum(self.F_ps, 1e-9))
        sliding = -jnp.expm1(-self.sigma_0 * jnp.abs(moved) / jnp.maximum(self.F_ps, 1e-9))
        return first_order(kept, sliding * self.F_ps * jnp.sign(moved), periodic=motion.periodic)
