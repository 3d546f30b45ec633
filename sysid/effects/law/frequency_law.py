"""Force that depends on frequency beside speed."""

from typing import ClassVar, Literal

import equinox as eqx
import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.motion.motion import Motion
from sysid.parameters import param


class FrequencyLaw(AbstractLawEffect):
    r"""A factor on the whole force, the yield part or the viscous part.

        F ← F (1 + ε_f log₁₀(f / 1 Hz))

    Nothing where the motion has no frequency.

    Attributes:
        part: "whole", "yield" or "viscous".

    Source:
        Departures from iso-velocity invariance, 2–10 % per decade.
    """

    facts: ClassVar[Facts] = Facts(
        id="frequency_law",
        family="rate_law",
        found_from="loops",
        size="eps_f",
        nominal={"eps_f": 0.05},
        realistic={"eps_f": (-0.1, 0.1)},
        parity=("OD", 0.93),
        exponents=None,
        rivals=("force_delay",),
        separating_test="pairs of tests with the same amplitude × frequency",
        source="departures from iso-velocity invariance",
    )
    eps_f: Scalar = param(
        symbol="eps_f", name="change of the force per decade of frequency", unit="-", typical=0.05
    )
    part: Literal["whole", "yield", "viscous"] = eqx.field(default="whole", static=True)

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts at the frequency of the test."""
        decades = jnp.log10(motion.frequency)
        factor = 1.0 + self.eps_f * jnp.where(jnp.isnan(decades), 0.0, decades)
        changes = Changes(
            yielding=1.0 if self.part == "viscous" else factor,
            viscous=1.0 if self.part == "yield" else factor,
        )
        return valve.changed(motion, changes)
