"""Gain error of the load cell."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractChannelEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class LoadCellGain(AbstractChannelEffect):
    r"""A factor on the recorded force; the force scale of a base model absorbs it.

        F_rec = (1 + g_c) F

    Source:
        Calibration of load cells, 0.5–2 %.
    """

    facts: ClassVar[Facts] = Facts(
        id="load_cell_gain",
        family="acquisition",
        found_from="invisible",
        size="g_c",
        nominal={"g_c": 0.01},
        realistic={"g_c": (-0.02, 0.02)},
        parity=("OD", 0.93),
        exponents=(0.42, 0.4, 0.39),
        rivals=(),
        separating_test="dead weight, or a second load cell",
        source="calibration of load cells",
    )
    g_c: Scalar = param(symbol="g_c", name="gain error of the load cell", unit="-", typical=0.01)

    def recorded(self, force: Force, motion: Motion) -> Force:
        """Force with the gain error."""
        return force * (1.0 + self.g_c)
