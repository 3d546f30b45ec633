"""Third harmonic of the actuator."""

from collections.abc import Callable
from typing import ClassVar

import jax.numpy as jnp

from sysid.arrays import Scalar
from sysid.effects.base import AbstractMotionEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class WaveformDistortion(AbstractMotionEffect):
    r"""The actuator adds a third harmonic that a nominal sinusoid lacks.

        x_v = x + e_3 A sin 3φ,  and its derivatives

    A and φ are those of the fundamental.  A motion that is no cycle has none and stays as it is.

    Source:
        Servo-hydraulic actuators, 0.3–3 %; never needed where displacement was measured.
    """

    facts: ClassVar[Facts] = Facts(
        id="waveform_distortion",
        family="acquisition",
        found_from="check",
        size="e_3",
        nominal={"e_3": 0.01},
        realistic={"e_3": (-0.03, 0.03)},
        parity=("OD", 0.68),
        exponents=(0.45, 0.43, 0.49),
        rivals=("force_filter",),
        separating_test="use the measured displacement",
        source="servo-hydraulic actuators",
    )
    e_3: Scalar = param(symbol="e_3", name="third harmonic per fundamental", unit="-", typical=0.01)

    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion with the third harmonic."""
        if not motion.periodic:
            return motion
        n = motion.displacement.shape[-1]
        first = 2.0 / n * jnp.fft.rfft(motion.displacement, axis=-1)[..., 1:2] * 1j
        amplitude = jnp.abs(first)
        angle = 3.0 * (2.0 * jnp.pi * jnp.arange(n) / n + jnp.angle(first))
        speed = 6.0 * jnp.pi * motion.frequency
        size = self.e_3 * amplitude
        return motion.moved(
            motion.displacement + size * jnp.sin(angle),
            motion.velocity + size * speed * jnp.cos(angle),
            motion.acceleration - size * speed**2 * jnp.sin(angle),
        )
