"""Stop at the ends of the stroke."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class BumpStop(AbstractForceEffect):
    r"""A spring that begins at a distance from the centre.

        F = k_b (|x| − x_b)₊ sgn x

    Source:
        Rubber or hydraulic end stops, 10⁴–10⁶ N/m.
    """

    facts: ClassVar[Facts] = Facts(
        id="bump_stop",
        family="reactive",
        found_from="loops",
        size="k_b",
        nominal={"k_b": 20000.0, "x_b": 0.04},
        realistic={"k_b": (10000.0, 1000000.0), "x_b": (0.005, 0.1)},
        parity=("OC", 1.0),
        exponents=None,
        rivals=("gas_spring",),
        separating_test="shift the centre of the motion",
        source="end stops",
    )
    k_b: Scalar = param(
        symbol="k_b", name="stiffness of the stop", unit="N/m", typical=20000.0, low=0.0
    )
    x_b: Scalar = param(symbol="x_b", name="where the stop begins", unit="m", typical=0.04, low=0.0)

    def force(self, motion: Motion) -> Force:
        """Force of the stop."""
        x = motion.displacement
        return self.k_b * jnp.maximum(jnp.abs(x) - self.x_b, 0.0) * jnp.sign(x)
