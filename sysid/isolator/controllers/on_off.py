"""On/off skyhook control."""

import jax.numpy as jnp

from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.plant import Number
from sysid.isolator.skyhook import Sensed, dissipative


class OnOff(AbstractController):
    """I = I_max where the skyhook's force takes energy out, else 0 (BS09 Eqs. 2 and 6).

    Attributes:
        current: I_max, A.
    """

    current: Number

    def start(self) -> tuple[()]:
        """Nothing."""
        return ()

    def command(
        self, memory: tuple[()], sensed: Sensed, period: Number
    ) -> tuple[tuple[()], Number]:
        """On or off."""
        return memory, jnp.where(dissipative(sensed), self.current, 0.0)
