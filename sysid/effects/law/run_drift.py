"""Wear and loss of gas over a campaign."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.motion.motion import Motion
from sysid.parameters import param


class RunDrift(AbstractLawEffect):
    r"""The force falls from the first test to the last, or grows (d_r < 0) as the fluid thickens.

        F ← F (1 − d_r · place),   place = 0 (first test) … 1 (last)

    Nothing where the order of the tests is not known.

    Source:
        Replicated centre points of long campaigns, 1–5 %.  A fluid that thickens in use:
        J. D. Carlson, What makes a good MR fluid?, J. Intelligent Material Systems and Structures
        13 (2002) 431–435.
    """

    facts: ClassVar[Facts] = Facts(
        id="run_drift",
        family="run_history",
        found_from="history",
        size="d_r",
        nominal={"d_r": 0.03},
        realistic={"d_r": (-0.05, 0.05)},
        parity=("OD", 0.93),
        exponents=None,
        rivals=("viscosity_temperature", "yield_temperature"),
        separating_test="replicate one test at the start, in the middle and at the end",
        source="replicated centre points of long campaigns",
    )
    d_r: Scalar = param(
        symbol="d_r", name="loss of force over the campaign", unit="-", typical=0.03
    )

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts at the test's place in the campaign."""
        if motion.run_share is None:
            return valve(motion)
        factor = 1.0 - self.d_r * motion.run_share
        return valve.changed(motion, Changes(yielding=factor, viscous=factor))
