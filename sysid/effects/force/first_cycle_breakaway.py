"""Friction of the first cycles after a rest."""

from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.effects.smooth_sign import smooth_sign
from sysid.motion.motion import Motion
from sysid.parameters import param


class FirstCycleBreakaway(AbstractForceEffect):
    r"""Sedimented particles and a seal at rest take some cycles to come loose.

        F = F_br exp(−cycle / n_br) sgn_s(v),   sgn_s(v) = tanh(v / 0.3 mm/s)

    The number of the cycle is a whole one, for all of a cycle what is right at its middle, or runs
    within the cycle.  Nothing where the number of the cycle is not known.

    Source:
        Series of rest times of MR dampers (1 min, 1 h, 1 d), 20–100 N.
    """

    facts: ClassVar[Facts] = Facts(
        id="first_cycle_breakaway",
        family="run_history",
        found_from="history",
        size="F_br",
        nominal={"F_br": 50.0, "n_br": 2.0},
        realistic={"F_br": (20.0, 100.0), "n_br": (0.5, 5.0)},
        parity=("OD", 1.0),
        exponents=(0.0, 0.0, 0.0),
        rivals=("self_heating", "seal_friction"),
        separating_test="a series of rest times: one minute, one hour, one day",
        source="series of rest times of MR dampers",
    )
    F_br: Scalar = param(
        symbol="F_br", name="friction of the first cycle", unit="N", typical=50.0, low=0.0
    )
    n_br: Scalar = param(
        symbol="n_br",
        name="cycles until it has fallen to 1/e",
        unit="-",
        typical=2.0,
        low=0.01,
        scale="log",
    )

    def force(self, motion: Motion) -> Force:
        """Friction."""
        if motion.cycle is None:
            return jnp.zeros_like(motion.displacement)
        left = jnp.exp(-motion.cycle / self.n_br)
        return self.F_br * left * smooth_sign(motion.velocity)
