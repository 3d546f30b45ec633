"""Free play between rod and valve."""

from collections.abc import Callable
from typing import ClassVar

import equinox as eqx

from sysid.arrays import Scalar
from sysid.effects.base import AbstractMotionEffect, Facts, Force
from sysid.effects.travel import engaged_beyond, mean_over_steps, travelled
from sysid.motion.motion import Motion
from sysid.parameters import param


class Backlash(AbstractMotionEffect):
    r"""After both reversals the valve stands still until the play δ is used up.

        v_v = v g,   g = 0 while |x − x_rev| < δ, else 1

    g is a mean over a sampling step, so that δ has a derivative between samples.  A valve that
    stands still does not accelerate either.  It holds the force that it has at rest: the sign of
    acceleration, by which the base knows the side of its hysteresis, stays.  Displacement is that
    of the rod.

    Source:
        Play operator: M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (1996).
        Joints and rod ends of test rigs: 0.02–0.5 mm.
    """

    facts: ClassVar[Facts] = Facts(
        id="backlash",
        family="lost_motion",
        found_from="loops",
        size="delta",
        nominal={"delta": 2.0e-4},
        realistic={"delta": (2.0e-5, 5.0e-4)},
        parity=None,
        exponents=(-0.39, 0.44, 0.23),
        rivals=("entrained_air", "series_compliance", "seating_leakage"),
        separating_test="the smallest amplitude, with and without a preload on the rod",
        source="play operator (Brokate & Sprekels 1996); rod ends of test rigs",
    )
    delta: Scalar = param(
        symbol="delta", name="free play, whole gap", unit="m", low=0.0, typical=2.0e-4
    )

    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion of the valve, which stands still inside the play."""
        steps = travelled(motion, self.delta)
        g = mean_over_steps(motion, steps, engaged_beyond(self.delta))
        return eqx.tree_at(
            lambda m: (m.velocity, m.acceleration),
            motion,
            (motion.velocity * g, motion.acceleration * g),
        )
