"""Loop width that goes with travel instead of speed."""

from typing import ClassVar, Final, Literal

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Facts, Parts, ValveParts
from sysid.motion.motion import Motion
from sysid.parameters import param

AMPLITUDE: Final = 0.01
"""m, A_0: the amplitude at which the width stays as it was."""
SMALLEST: Final = 1e-5
"""m, amplitude below which the width is that at this one."""


class WidthLaw(AbstractLawEffect):
    r"""Between a width that grows with speed and one that is a constant travel.

    With the width v_h = κ v_m of the base, whatever its law in current, a damper turns from
    reversal to zero force over a travel of about A κ²/2, in proportion to amplitude.

        v_h ← v_h (A_0/A)^{p_w},   A_0 = 10 mm

    makes it go as A^{1 − 2 p_w}: p_w = 0 is the base, p_w = 1/2 a travel that stays the same at
    every amplitude and frequency.  A is the amplitude of a cycle; of any other motion it is
    v_m²/|ẍ|, which on a sinusoid is right at the reversals, where the width counts.  Either the
    whole force or its yield part follows.  A_0 is a factor of κ, which absorbs it for the whole
    force; with the yield part p_w shifts by some hundredths if A_0 is chosen otherwise.  Nothing
    with a valve whose hysteresis does not follow the sign of acceleration.

    Attributes:
        part: "whole" or "yield".

    Source:
        W11 Table 2: widths of the 2.5 mm and the 12.5 mm set (the travel is the same within an
        eighth with field).  A travel at which an MR damper yields, whatever the rate, measured:
        X.-X. Bai, P. Chen, On the Hysteresis Mechanism of Magnetorheological Fluids, Frontiers in
        Materials 6:36 (2019).  Field-induced solids before they flow: D. R. Gamota,
        F. E. Filisko, Dynamic mechanical studies of electrorheological materials: moderate
        frequencies, Journal of Rheology 35 (1991) 399–425.
    """

    facts: ClassVar[Facts] = Facts(
        id="width_law",
        family="rate_law",
        found_from="loops",
        size="p_w",
        nominal={"p_w": 0.5},
        realistic={"p_w": (0.1, 0.6)},
        parity=("OC", 0.63),
        exponents=None,
        rivals=("series_compliance", "force_delay", "force_filter"),
        separating_test=(
            "one current at amplitudes 1:5 and several frequencies: the travel from reversal to "
            "zero force stays, where with a spring it grows with the force and with a delay with "
            "the speed"
        ),
        source="W11 Table 2, both sets; Bai & Chen, Front. Mater. 6:36 (2019)",
    )
    p_w: Scalar = param(
        symbol="p_w", name="exponent of the loop width in 1/amplitude", unit="-", typical=0.5
    )
    part: Literal["whole", "yield"] = eqx.field(default="whole", static=True)

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts with the width at the amplitude of the motion."""
        share = (AMPLITUDE / _amplitude(motion)) ** self.p_w
        changed = valve(
            eqx.tree_at(lambda m: m.acceleration_sign, motion, motion.acceleration_sign * share)
        )
        if self.part == "whole":
            return changed
        return Parts(yielding=changed.yielding, viscous=valve(motion).viscous)


def _amplitude(motion: Motion) -> Float[Array, "..."]:
    """Amplitude of the motion about each instant, m."""
    if motion.periodic:
        return motion.peak_velocity / (2.0 * jnp.pi * motion.frequency)
    braking = jnp.maximum(jnp.abs(motion.acceleration), 1e-6)
    return jnp.maximum(motion.peak_velocity**2 / braking, SMALLEST)
