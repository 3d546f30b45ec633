"""Oil that the damper's own work warms within a test."""

from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.effects.oil_heat import mean_power, thinning
from sysid.motion.motion import Motion
from sysid.parameters import param


class SelfHeating(AbstractLawEffect):
    r"""The temperature of the oil rises from the start of a test on, and its viscosity falls.

        T' = r_h F v − h_a (T − T_a),   T = T_a at the start of the first cycle
        T_c − T_a = r_h P (1 − exp(−h_a t_c)) / h_a,   t_c = (cycle + ½)/f
        F_visc ← F_visc exp(−0.5 %/K · (T_c − T_a))

    A whole number of the cycle stands for its middle; it may also run within the cycle.  P is the
    mean of F v over a cycle, of the valve at T_a: what the fall of viscosity takes from it is of
    second order, and so is its course within a cycle.  r_h = 1/(m c), h_a = h/(m c).  Forces show
    only the product of r_h and the loss of viscosity per kelvin, which is 0.5 % here: another
    oil has another r_h.  T_a is the recorded temperature; a law of temperature on it is an effect
    of its own.

    Nothing where the number of the cycle or the frequency is not known, so on loops of which only
    the mean over cycles is known.

    Source:
        Heat balance of the oil; BS09 Table 1 (C_post).
    """

    facts: ClassVar[Facts] = Facts(
        id="self_heating",
        family="thermal",
        found_from="history",
        size="r_h",
        nominal={"r_h": 1.0e-3, "h_a": 5.0e-3},
        realistic={"r_h": (1.0e-4, 1.0e-2), "h_a": (1.0e-3, 5.0e-2)},
        parity=("OD", 0.98),
        exponents=(1.85, 0.81, 0.38),
        rivals=("first_cycle_breakaway", "surface_temperature", "run_drift"),
        separating_test=(
            "the same work in fewer, larger cycles: heating goes with work, breakaway with the "
            "number of cycles; and a test of many cycles with the oil's temperature recorded"
        ),
        source="heat balance of the oil, BS09 Table 1",
    )
    r_h: Scalar = param(
        symbol="r_h", name="heating per work, 1/(m c)", unit="K/J", typical=1.0e-3, low=0.0
    )
    h_a: Scalar = param(
        symbol="h_a", name="rate of cooling", unit="1/s", typical=5.0e-3, low=0.0, scale="log"
    )

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts in the oil of the cycle."""
        parts = valve(motion)
        if motion.cycle is None or not motion.periodic:
            return parts
        rise = self.r_h * mean_power(motion, parts.total) * self._held(motion)
        return valve.changed(motion, Changes(viscous=thinning(rise)), parts)

    def _held(self, motion: Motion) -> Float[Array, "*batch h"]:
        """(1 − exp(−h_a t))/h_a in s, which is t without cooling; 0 without a frequency."""
        assert motion.cycle is not None
        known = jnp.isfinite(motion.frequency) & (motion.frequency > 0.0)
        time = jnp.where(known, (motion.cycle + 0.5) / jnp.where(known, motion.frequency, 1.0), 0.0)
        turns = self.h_a * time
        small = turns < 1e-6
        whole = -jnp.expm1(-turns) / jnp.where(small, 1.0, turns)
        return time * jnp.where(small, 1.0 - 0.5 * turns, whole)
