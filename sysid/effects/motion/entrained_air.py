"""Entrained air or cavitation on one side of the piston."""

from collections.abc import Callable
from typing import ClassVar, Literal

import equinox as eqx
import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractMotionEffect, Facts, Force
from sysid.effects.travel import engaged_beyond, held_still, mean_over_steps, strides, travelled
from sysid.motion.motion import Motion
from sysid.parameters import param


class EntrainedAir(AbstractMotionEffect):
    r"""After the reversal into one direction a column of air closes before fluid is moved.

        v_v = v g,   g = 0 while side · v > 0 and |x − x_rev| < δ_a, else 1

    As `Backlash`, in one direction only.  Displacement stays that of the piston; what has a state
    goes by `Motion.travel`, that of the fluid, which over a cycle does not come back.

    Attributes:
        side: 1 in compression, −1 in rebound.

    Source:
        S. F. Alonso, Cavitation and aeration in dampers; J. C. Dixon, The Shock Absorber
        Handbook (2007), §6.8: 0.1–2 mm of lost stroke.
    """

    facts: ClassVar[Facts] = Facts(
        id="entrained_air",
        family="lost_motion",
        found_from="loops",
        size="delta_a",
        nominal={"delta_a": 5.0e-4},
        realistic={"delta_a": (1.0e-4, 2.0e-3)},
        parity=None,
        exponents=(-0.41, 0.44, 0.25),
        rivals=("asymmetric_gain", "backlash", "seating_leakage"),
        separating_test="raise the gas pressure; compare the first cycle with the twentieth",
        source="Dixon, The Shock Absorber Handbook (2007), ch. 6",
    )
    delta_a: Scalar = param(
        symbol="delta_a", name="travel lost to air", unit="m", low=0.0, typical=5.0e-4
    )
    side: Literal[-1, 1] = eqx.field(default=1, static=True)

    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion of the fluid, which stands still while air is compressed."""
        steps = travelled(motion, self.delta_a)
        steps = steps._replace(
            before=jnp.where(self.side * steps.moved > 0.0, steps.before, self.delta_a)
        )
        g = mean_over_steps(motion, steps, engaged_beyond(self.delta_a))
        return held_still(motion, g, strides(motion, steps, engaged_beyond(self.delta_a)))
