"""Lag of coil and eddy currents."""

from typing import ClassVar

from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import AbstractDriveEffect, Facts
from sysid.effects.causal import lagged
from sysid.motion.motion import Motion
from sysid.parameters import param


class CoilLag(AbstractDriveEffect):
    r"""The effective current follows the command with a time constant.

    Exactly nothing at constant current.  Periodic currents by their harmonics, others exactly
    where straight between samples.

        τ_i di_eff/dt = i − i_eff

    Source:
        BS09 (3 ms); coils and cores of MR dampers, 1–25 ms.
    """

    facts: ClassVar[Facts] = Facts(
        id="coil_lag",
        family="current_law",
        found_from="invisible",
        size="tau_i",
        nominal={"tau_i": 0.005},
        realistic={"tau_i": (0.001, 0.025)},
        parity=None,
        exponents=None,
        rivals=(),
        separating_test="steps or sinusoids of the current at constant velocity",
        source="BS09, 3 ms",
    )
    tau_i: Scalar = param(
        symbol="tau_i", name="time constant of the current", unit="s", typical=0.005, low=0.0
    )

    def current(self, motion: Motion) -> Float[Array, "*batch c"]:
        """Current behind the lag."""
        if motion.current.shape[-1] == 1:
            return motion.current
        return lagged(motion.current, motion, self.tau_i)
