"""Field that remembers where the current came from."""

from typing import ClassVar

from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import AbstractDriveEffect, Facts
from sysid.motion.motion import Motion
from sysid.parameters import param


class MagneticHysteresis(AbstractDriveEffect):
    r"""The effective current lags behind the last change of current.

        i_eff = i − i_h · ramp,   ramp = 1 where the current was raised, −1 where it was lowered

    Nothing where the order of the tests is not known.

    Source:
        Width of the major loop of soft iron as current (Preisach, Jiles–Atherton), 5–30 mA.
    """

    facts: ClassVar[Facts] = Facts(
        id="magnetic_hysteresis",
        family="current_law",
        found_from="history",
        size="i_h",
        nominal={"i_h": 0.015},
        realistic={"i_h": (-0.03, 0.03)},
        parity=("OD", 0.88),
        exponents=None,
        rivals=("residual_magnetism", "run_drift"),
        separating_test="the same currents ascending and descending",
        source="width of the major loop of soft iron",
    )
    i_h: Scalar = param(
        symbol="i_h", name="half width of the magnetic loop as current", unit="A", typical=0.015
    )

    def current(self, motion: Motion) -> Float[Array, "*batch c"]:
        """Current that makes the field."""
        if motion.ramp is None:
            return motion.current
        return motion.current - self.i_h * motion.ramp
