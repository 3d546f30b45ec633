"""Field that remains without current."""

from typing import ClassVar

from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import AbstractDriveEffect, Facts
from sysid.motion.motion import Motion
from sysid.parameters import param


class ResidualMagnetism(AbstractDriveEffect):
    r"""A constant on top of the current; the current offsets of a base model absorb it.

        i_eff = i + i_r

    Source:
        Remanence of the core, 10–50 mA.
    """

    facts: ClassVar[Facts] = Facts(
        id="residual_magnetism",
        family="current_law",
        found_from="invisible",
        size="i_r",
        nominal={"i_r": 0.02},
        realistic={"i_r": (-0.05, 0.05)},
        parity=("OD", 0.88),
        exponents=(0.42, 0.4, -1.28),
        rivals=("magnetic_hysteresis",),
        separating_test="degauss with a decaying alternating current and repeat 0 A",
        source="remanence of the core",
    )
    i_r: Scalar = param(symbol="i_r", name="residual magnetism as current", unit="A", typical=0.02)

    def current(self, motion: Motion) -> Float[Array, "*batch c"]:
        """Current with the remanence."""
        return motion.current + self.i_r
