"""Heat balance: oil and body apart, and a thermocouple on the body.

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

import equinox as eqx
from jax import Array

from sysid.rig.physical.constant import Constant


class HeatBalance(eqx.Module):
    """Two bodies of heat in series with the room.

    Attributes:
        oil: Heat capacity of oil and piston, J/K.
        body: The same of cylinder and ends, J/K.
        inner: Oil to body, W/K.
        outer: Body to room, W/K.
        room: °C.
        thermocouple: Lag of the thermocouple, s.
    """

    oil: Constant
    body: Constant
    inner: Constant
    outer: Constant
    room: Constant
    thermocouple: Constant

    def rates(self, power: Array, oil: Array, body: Array) -> tuple[Array, Array]:
        """dT/dt of oil and body, K/s.

        Args:
            power: Heat set free in the oil, W.
            oil: °C.
            body: °C.
        """
        passed = self.inner * (oil - body)
        return (power - passed) / self.oil, (passed - self.outer * (body - self.room)) / self.body
