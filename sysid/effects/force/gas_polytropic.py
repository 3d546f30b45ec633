"""Curvature of a polytropic gas spring."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class GasPolytropic(AbstractForceEffect):
    r"""The gas force without its value and slope at the centre.

    Those are `force_offset` and `gas_spring`.

        F = F_g [(1 − x/x_g)^(−n) − 1 − n x/x_g],   F_g = P_0 A_r,   x_g = V_0 / A_r

    The argument of the power is kept above 0.05: the gas column cannot be closed.

    Source:
        Polytropic gas, n from 1.0 (slow) to 1.4; V_0 = (1–3)·10⁻⁵ m³, A_r = (0.8–1.1)·10⁻⁴ m².
    """

    facts: ClassVar[Facts] = Facts(
        id="gas_polytropic",
        family="gas_nonlinear",
        found_from="loops",
        size="F_g",
        nominal={"F_g": 200.0, "x_g": 0.2, "n_g": 1.2},
        realistic={"F_g": (150.0, 250.0), "x_g": (0.1, 0.35), "n_g": (1.0, 1.4)},
        parity=("EC", 0.89),
        exponents=(2.05, 0.0, 0.0),
        rivals=("force_offset", "gas_spring"),
        separating_test="the largest amplitude at two frequencies",
        source="polytropic gas",
    )
    F_g: Scalar = param(symbol="F_g", name="gas force at the centre", unit="N", typical=200.0)
    x_g: Scalar = param(
        symbol="x_g", name="length of the gas column", unit="m", typical=0.2, low=0.0, scale="log"
    )
    n_g: Scalar = param(symbol="n_g", name="polytropic exponent", unit="-", typical=1.2, low=1.0)

    def force(self, motion: Motion) -> Force:
        """Force of the gas beyond its tangent."""
        z = motion.displacement / self.x_g
        column = jnp.maximum(1.0 - z, 0.05)
        return self.F_g * (column**-self.n_g - 1.0 - self.n_g * z)
