"""Leakage past a ring or plate until it has come to its seat after a reversal."""

from typing import ClassVar, Final

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Facts, Parts, ValveParts
from sysid.effects.leak import parts_beside_leak
from sysid.effects.travel import mean_over_steps, travelled
from sysid.motion.motion import Motion
from sysid.parameters import param

_LEAST: Final = 1e-9
"""Part of the travel below which powers of it are zero; keeps their derivatives finite."""


class SeatingLeakage(AbstractLawEffect):
    r"""After each reversal fluid passes beside the valve, until a loose part has come to its seat.

        v_eff = v − k F(v_eff),   k = k_s (1 − (T/δ_s)^n_s) while T < δ_s, else 0

    T is the travel since the reversal; a part that was not seated turns back from where it is.  A
    piston ring that lies loose in its groove stays with the cylinder wall while the piston turns
    back, and so does a floating plate; the gap that it leaves closes in proportion to travel
    (n_s = 1).  Where the gap is no bottleneck before it is nearly shut, because the way to it is
    narrower, the leak stays and ends abruptly (n_s large; from 20 on, within the last tenth of the
    travel, no test would tell).
    Meanwhile the force is limited by the leak, F ≈ v/k, whatever
    the current, and rises to the level of the current when the leak closes: a shelf after each
    reversal that ends after the same travel at every frequency and current, whose height grows
    with speed.  k_s = 0 is the identity.  k is a mean over a sampling step.

    Source:
        Laminar flow through a gap; floating rings as leakage paths: J. C. Dixon, The Shock
        Absorber Handbook (2007), ch. 5.
    """

    facts: ClassVar[Facts] = Facts(
        id="seating_leakage",
        family="lost_motion",
        found_from="loops",
        size="k_s",
        nominal={"k_s": 2.0e-5, "delta_s": 4.0e-4, "n_s": 1.0},
        realistic={"k_s": (5.0e-6, 1.0e-4), "delta_s": (1.0e-4, 1.0e-3), "n_s": (1.0, 8.0)},
        parity=("OC", 0.61),
        exponents=(-0.23, 0.02, 0.8),
        rivals=("backlash", "series_compliance", "bypass_leakage"),
        separating_test=(
            "small amplitudes at several speeds and the highest current: the shelf of a leak grows "
            "with speed, that of play in the rod does not; a spring has no shelf, and its travel "
            "is proportional to the force"
        ),
        source="laminar leakage past a ring that is loose in its groove",
    )
    k_s: Scalar = param(
        symbol="k_s", name="leakage per force at reversal", unit="m/(s·N)", low=0.0, typical=2.0e-5
    )
    delta_s: Scalar = param(
        symbol="delta_s", name="travel until the part is seated", unit="m", low=0.0,
        typical=4.0e-4, scale="log",
    )  # fmt: skip
    n_s: Scalar = param(
        symbol="n_s", name="abruptness of seating", unit="-", low=0.0, high=20.0, typical=1.0
    )

    def leakage(self, motion: Motion) -> Float[Array, "*batch n"]:
        """K by the travel since the last reversal."""
        gap = jnp.maximum(self.delta_s, 1e-12)

        def closed(travel: Float[Array, "*batch n"]) -> Float[Array, "*batch n"]:
            within = jnp.minimum(travel, gap)
            share = jnp.maximum(within / gap, _LEAST)
            return within * share**self.n_s / (1.0 + self.n_s) + (travel - within)

        steps = travelled(motion, gap)
        open_share = 1.0 - mean_over_steps(motion, steps, closed)
        return self.k_s * open_share

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts at the speed that does not leak."""
        return parts_beside_leak(motion, valve, self.leakage(motion))
