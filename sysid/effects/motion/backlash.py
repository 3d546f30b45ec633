"""Free play between rod and valve."""

from collections.abc import Callable
from typing import ClassVar, Literal

import equinox as eqx
import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractMotionEffect, Facts, Force
from sysid.effects.travel import (
    Part,
    engaged_beyond,
    held_still,
    mean_carried,
    mean_over_steps,
    strides,
    travelled,
)
from sysid.motion.motion import Motion
from sysid.parameters import param


class Backlash(AbstractMotionEffect):
    r"""After both reversals the valve stands still, or carries nothing, until the play is used up.

    Held (friction of guide and seals, or gas, holds the piston while the rod crosses the gap):

        v_v = v g,   g = 0 while |x − x_rev| < δ, else 1

    A valve that stands still has the force that it has at rest: the sign of acceleration, by which
    the base knows the side of its hysteresis, stays.  So does acceleration itself, for masses: they
    take up the rod's momentum when the gap is closed.
    Displacement is that of the rod; what has a state goes by `Motion.travel`, that of the valve.

    Loose (a pin in an eye, and nothing that pushes the piston):

        F = g Φ(v),   g = 0 while the rod crosses the gap, else 1

    The pin stays in contact after a reversal until the force Φ of the valve pulls with the motion
    no more; from there on the rod travels δ and carries nothing, and strikes.

    g is the share of the time about each sample (`mean_over_steps`), and the force of a loop the
    mean over that time, so δ has a derivative between samples.

    Attributes:
        joint: "held" or "loose".

    Source:
        Play operator: M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (1996).
        Dead zone of joints without preload: M. Nordin, P.-O. Gutman, Automatica 38 (2002) 1633.
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
        exponents=(-0.49, 0.42, 0.21),
        rivals=("entrained_air", "series_compliance", "seating_leakage"),
        separating_test="the smallest amplitude, with and without a preload on the rod",
        source="play operator (Brokate & Sprekels 1996); rod ends of test rigs",
    )
    delta: Scalar = param(
        symbol="delta", name="free play, whole gap", unit="m", low=0.0, typical=2.0e-4
    )

    joint: Literal["held", "loose"] = eqx.field(default="held", static=True)

    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion of the valve, which stands still inside the play if something holds it."""
        if self.joint == "loose":
            return motion
        steps = travelled(motion, self.delta)
        g = mean_over_steps(motion, steps, engaged_beyond(self.delta))
        return held_still(motion, g, strides(motion, steps, engaged_beyond(self.delta)))

    def carried(self, force: Force, motion: Motion) -> Force:
        """The force, but none while a loose joint crosses its gap."""
        if self.joint == "held":
            return force
        steps = travelled(motion, self.delta, _driving(force, motion))
        g = mean_over_steps(motion, steps, engaged_beyond(self.delta))
        return mean_carried(force, g) if motion.periodic else force * g


def _driving(force: Force, motion: Motion) -> Part:
    """In which part of the step before each sample the rod pushes against the force.

    The force is taken as straight between samples, so that contact ends between them.
    """
    direction = jnp.sign(motion.displacement - jnp.roll(motion.displacement, 1, axis=-1))
    after, before = direction * force, direction * jnp.roll(force, 1, axis=-1)
    turns = after * before < 0.0
    place = before / jnp.where(turns, before - after, 1.0)
    begin = jnp.where(before >= 0.0, 0.0, jnp.where(turns, place, 1.0))
    end = jnp.where(after >= 0.0, 1.0, jnp.where(turns, place, begin))
    return Part(begin, end)
