"""Delay of the velocity channel."""

from collections.abc import Callable
from typing import ClassVar

import equinox as eqx

from sysid.arrays import Scalar
from sysid.effects.base import AbstractMotionEffect, Facts, Force
from sysid.effects.causal import delayed
from sysid.motion.motion import Motion
from sysid.parameters import param


class VelocityDelay(AbstractMotionEffect):
    r"""The valve sees a velocity that is late beside displacement and acceleration.

        v_v(t) = v(t − τ_v)

    What has a state (`Motion.travel`) goes through the displacement that belongs to this velocity.

    Source:
        Velocity transducers and causal differentiation, 0.1–1 ms.
    """

    facts: ClassVar[Facts] = Facts(
        id="velocity_delay",
        family="timing",
        found_from="check",
        size="tau_v",
        nominal={"tau_v": 0.0005},
        realistic={"tau_v": (0.0001, 0.001)},
        parity=("OC", 0.73),
        exponents=(0.46, 1.43, 0.39),
        rivals=("force_delay",),
        separating_test="compare the velocity channel with the derivative of displacement",
        source="velocity transducers",
    )
    tau_v: Scalar = param(
        symbol="tau_v", name="delay of the velocity channel", unit="s", typical=0.0005
    )

    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion with the velocity as it was τ_v ago."""
        late, place = (
            delayed(z, motion, self.tau_v) for z in (motion.velocity, motion.displacement)
        )
        travel = motion.strides_to(place)
        return eqx.tree_at(
            lambda m: (m.velocity, m.travel, m.share),
            motion,
            (late, travel, None),
            is_leaf=lambda z: z is None,
        )
