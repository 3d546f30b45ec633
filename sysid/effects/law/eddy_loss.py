"""Field that weakens with speed."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.motion.motion import Motion
from sysid.parameters import param


class EddyLoss(AbstractLawEffect):
    r"""Eddy currents and back-EMF take from the field, and so from the yield part.

        F_yield ← F_yield (1 − η_e |v|)

    Source:
        Eddy currents in a solid core; 2–10 % at 0.2 m/s.
    """

    facts: ClassVar[Facts] = Facts(
        id="eddy_loss",
        family="viscous",
        found_from="loops",
        size="eta_e",
        nominal={"eta_e": 0.25},
        realistic={"eta_e": (0.1, 0.5)},
        parity=("OD", 0.99),
        exponents=(1.42, 1.4, 0.58),
        rivals=("quadratic_loss", "linear_viscosity"),
        separating_test="current steps at constant velocity",
        source="eddy currents in a solid core",
    )
    eta_e: Scalar = param(
        symbol="eta_e", name="loss of yield force per speed", unit="s/m", typical=0.25
    )

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts with a weaker yield part."""
        kept = 1.0 - self.eta_e * jnp.abs(motion.velocity)
        return valve.changed(motion, Changes(yielding=kept))
