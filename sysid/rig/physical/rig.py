"""What holds the damper: servo-hydraulic actuator, mounts with play, and the load cell's place.

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from sysid.rig.physical.constant import Constant


class Rig(eqx.Module):
    """A test machine with a damper in it.

    Attributes:
        servo: Bandwidth of the position loop, rad/s.
        column: Stiffness of the actuator's oil, N/m: force pushes the ram back at once, the loop
            brings it to where it should be.
        mount: Stiffness of both mounts and the load cell, N/m.
        play: Whole gap of the mounts, m.
        restitution: λ of Hunt and Crossley's contact, s/m: what the joints lose when bent.
    """

    servo: Constant
    column: Constant
    mount: Constant
    play: Constant
    restitution: Constant

    def spring(self, free: Array, piston: Array) -> Array:
        """Elastic force of the mounts, N, where the ram without load and the piston are apart."""
        apart = free - piston
        bent = apart - jnp.clip(apart, -0.5 * self.play, 0.5 * self.play)
        return bent / (1.0 / self.mount + 1.0 / self.column)

    def force(self, spring: Array, rate: Array) -> Array:
        """Force through the mounts, N, when they are bent further at a rate, m/s.

        F = k δ (1 + λ δ̇): no jump where the play ends.

        Source:
            Hunt, Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J.
            Appl. Mech. 42 (1975) 440–445.
        """
        return spring + jnp.abs(spring) * self.restitution * rate

    def ram(self, free: Array, force: Array) -> Array:
        """Position of the ram, m, which is what the displacement transducer sees."""
        return free - force / self.column

    def servo_rate(self, ram: Array, command: Array, speed: Array) -> Array:
        """Speed of the ram without load, m/s: the loop with feed-forward of the command's speed."""
        return self.servo * (command - ram) + speed
