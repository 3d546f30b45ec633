"""The annular valve: two magnetised poles and the coil's window between them, in series.

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from sysid.rig.physical.constant import Constant
from sysid.rig.physical.oil import Oil
from sysid.rig.physical.slot_flow import power_law_stress, slot_flow


class Valve(eqx.Module):
    """The gap in the piston.

    Attributes:
        gap: h, m.
        width: w, mean circumference of the gap, m.
        active: Length under the poles, both together, m.
        passive: Length without field, m.
        entrance: ζ of entrance, exit and bends, with Δp = ζ ρ/2 (Q/wh)².
        creep: Flow of the fluid that has not yet yielded, m³/s/Pa: it is very thick, not solid.
    """

    gap: Constant
    width: Constant
    active: Constant
    passive: Constant
    entrance: Constant
    creep: Constant

    def flow(self, drop: Array, oil: Oil, yield_stress: Array, temperature: Array) -> Array:
        """Q, m³/s, that friction under the poles lets through at a drop of pressure there, Pa."""
        stress = 0.5 * drop * self.gap / self.active
        area = self.width * self.gap**2
        thickness = oil.thickness(temperature)
        yielded = slot_flow(stress, yield_stress, thickness, jnp.asarray(oil.exponent), area)
        return yielded + self.creep * drop

    def rest_of_drop(self, flow: Array, oil: Oil, temperature: Array) -> Array:
        """Drop of pressure outside the field, Pa: friction in the window, and the ends."""
        area = self.width * self.gap**2
        thickness = oil.thickness(temperature)
        stress = power_law_stress(
            flow, thickness, jnp.asarray(oil.exponent), area, jnp.asarray(oil.slowest_shear)
        )
        speed = self.jet(flow)
        ends = 0.5 * self.entrance * oil.density * speed * jnp.abs(speed)
        return 2.0 * stress * self.passive / self.gap + ends

    def jet(self, flow: Array) -> Array:
        """Mean speed in the gap, m/s."""
        return flow / (self.width * self.gap)

    def inertance(self, oil: Oil) -> Array:
        """ρ L/(w h), kg/m⁴: pressure that a change of flow takes."""
        length = self.active + self.passive
        return jnp.asarray(oil.density * length / (self.width * self.gap))
