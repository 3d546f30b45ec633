"""LuGre friction of a seal: bristles that bend before they slip.

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from sysid.rig.physical.constant import Constant


class Seal(eqx.Module):
    """A rubber lip on a rod or a floating piston.

    Attributes:
        sliding: F_c, force of fast sliding, N.
        breakaway: F_s, N, not below F_c.
        per_pressure: Rise of both with the pressure that the lip holds back, N/Pa.
        stribeck_speed: v_s, m/s.
        stiffness: σ_0 of the bristles, N/m.
        damping: σ_1 of the bristles, N·s/m; it fades with the speed v_s, or the bristles would
            resist every fast reversal by σ_1 times twice the speed.
        viscous: σ_2, N·s/m.
    """

    sliding: Constant
    breakaway: Constant
    per_pressure: Constant
    stribeck_speed: Constant
    stiffness: Constant
    damping: Constant
    viscous: Constant

    def slip_force(self, velocity: Array, pressure: Array) -> Array:
        """g(v) = F_c + (F_s − F_c) exp(−(v/v_s)²), N, at a gauge pressure, Pa."""
        stribeck = jnp.exp(-jnp.square(velocity / self.stribeck_speed))
        more = self.per_pressure * pressure
        return self.sliding + more + (self.breakaway - self.sliding) * stribeck

    def sliding_at(self, velocity: Array, bend: Array, pressure: Array) -> tuple[Array, Array]:
        """Force on the rod, N, and ż, m/s, at a known speed.

        ż = v − σ_0 |v| z / g(v),   F = σ_0 z + σ_1 exp(−(v/v_s)²) ż + σ_2 v

        Source:
            Canudas de Wit, Olsson, Åström, Lischinsky, A new model for control of systems with
            friction, IEEE Trans. Automatic Control 40 (1995) 419–425.
        """
        slip = self.slip_force(velocity, pressure)
        bending = velocity - self.stiffness * jnp.abs(velocity) * bend / slip
        fading = self.damping * jnp.exp(-jnp.square(velocity / self.stribeck_speed))
        return self.stiffness * bend + fading * bending + self.viscous * velocity, bending

    def driven_by(self, force: Array, bend: Array) -> tuple[Array, Array]:
        """Speed, m/s, of a part without mass on which a force acts, and ż; with g = F_c.

        F = σ_0 z + σ_1 (v − σ_0 |v| z / F_c) + σ_2 v is linear in v on either side of 0, where
        the bristles are bent no further than F_c / σ_0.
        """
        net = force - self.stiffness * bend
        share = jnp.clip(jnp.sign(net) * self.stiffness * bend / self.sliding, -1.0, 1.0)
        velocity = net / (self.damping * (1.0 - share) + self.viscous)
        return velocity, velocity * (1.0 - share)
