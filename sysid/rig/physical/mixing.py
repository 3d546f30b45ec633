"""Gas that comes out of solution where agitated oil is under little pressure.

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from sysid.rig.physical.constant import Constant

_LEAST = 1e-9
"""Stands for no gas at all where a quotient is taken."""


class Mixing(eqx.Module):
    """Gas mixing in the chamber on the rod's side, which compression relieves of pressure.

    In fast compression under a strong field the pressure there falls below that at which the oil
    is saturated; oil that comes through the valve then foams.  Foam goes back into solution slowly,
    so a fast test keeps it from stroke to stroke while a slow one loses it between two.

    Attributes:
        saturation: Pressure at which the oil is saturated with gas, absolute, Pa.
        release: Rate at which gas comes out at no pressure at all where the jet from the valve has
            1 m/s; it goes with the jet's energy.  1/s, share at atmospheric pressure.
        dissolving: Time in which foam goes back into solution, s.
        most: Gas that is there to come out, share at atmospheric pressure.

    Source:
        W11 section 2.2 and Fig. 4b: wider hysteresis in compression at 0.3 A and 10 Hz or more,
        "attributed to possible mixing of gas in the MR-fluid".
    """

    saturation: Constant
    release: Constant
    dissolving: Constant
    most: Constant

    def rate(self, foam: Array, jet: Array, pressure: Array) -> Array:
        """Change of the free gas's share, 1/s.

        ṁ = r u² · max(0, 1 − p/p_sat) · (1 − m/m_most) − m/τ, u the jet's speed in m/s.
        """
        deficit = jnp.maximum(0.0, 1.0 - pressure / self.saturation)
        left = 1.0 - foam / jnp.maximum(self.most, _LEAST)
        return self.release * jet**2 * deficit * left - foam / self.dissolving
