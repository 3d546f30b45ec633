"""Lost motion inside the valve: the yield force comes late, the viscous one does not."""

from collections.abc import Callable
from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Facts, Parts
from sysid.effects.travel import engaged_beyond, mean_over_steps, travelled
from sysid.motion.motion import Motion
from sysid.parameters import param


class ValveLostMotion(AbstractLawEffect):
    r"""After each reversal the yield part drops out, until a body in the valve has travelled δ_v.

        F = F_visc + F_yield g,   g = clip((T − δ_v) / r, 0, 1),
        r = s |F_yield| δ_v / (δ_v + s |F_yield|)

    T is the travel since the reversal and s = s_v the compliance of the contact, which takes up
    the yield force over r; r is s |F_yield| where that is short beside the gap, and
    vanishes with the gap, so that δ_v = 0 is the identity.  g is a mean over a sampling step.

    A floating piston ring, or a valve body with axial play, lets fluid pass beside the energised
    gap until it sits: the force then hangs at its current-independent level for the same travel at
    every frequency, and rises to the level of the current with a finite stiffness.

    Source:
        Floating rings as by-pass: J. C. Dixon, The Shock Absorber Handbook (2007), ch. 5; play
        with a contact spring: M. Brokate, J. Sprekels (1996).
    """

    facts: ClassVar[Facts] = Facts(
        id="valve_lost_motion",
        family="lost_motion",
        found_from="loops",
        size="delta_v",
        nominal={"delta_v": 3.0e-4, "s_v": 1.0e-7},
        realistic={"delta_v": (5.0e-5, 1.0e-3), "s_v": (1.0e-8, 1.0e-6)},
        parity=("OC", 0.62),
        exponents=(0.28, 0.47, 0.74),
        rivals=("backlash", "entrained_air", "series_compliance"),
        separating_test=(
            "0 A against the highest current at one amplitude: play in the rod drops the whole "
            "force after a reversal, here the shelf is the force at 0 A; a spring has no shelf, "
            "and its travel is proportional to the force; air acts in one direction"
        ),
        source="floating ring with axial play; contact spring behind a play",
    )
    delta_v: Scalar = param(
        symbol="delta_v", name="travel lost inside the valve", unit="m", low=0.0, typical=3.0e-4
    )
    s_v: Scalar = param(
        symbol="s_v", name="compliance of the contact", unit="m/N", low=0.0, typical=1.0e-7
    )

    def parts(self, motion: Motion, valve: Callable[[Motion], Parts]) -> Parts:
        """The yield part without its share inside the gap."""
        parts = valve(motion)
        take_up = self.s_v * jnp.abs(parts.yielding)
        both = self.delta_v + take_up
        ramp = jnp.where(both > 0.0, take_up * self.delta_v / jnp.where(both > 0.0, both, 1.0), 0.0)
        steps = travelled(motion, 2.0 * self.delta_v)
        g = mean_over_steps(motion, steps, engaged_beyond(self.delta_v, ramp))
        return Parts(yielding=parts.yielding * g, viscous=parts.viscous)
