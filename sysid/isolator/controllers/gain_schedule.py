"""Skyhook control by a table from force to current, without force feedback."""

from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.errors import DataError
from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.plant import Number
from sysid.isolator.skyhook import Sensed, along, demand, dissipative

SPEED: Final = 0.25
"""v_p of BS09, m/s: half of the largest piston speed."""
TEMPERATURE: Final = 15.0
"""°C, of the paper's table."""


class GainSchedule(AbstractController):
    """I from F_q(I) = F_y(I) + C_post(I) v_p, inverted as a table (BS09 Eq. 5), 0 by Eq. 2.

    Attributes:
        damping: D, N·s/m.
        forces: [n] F_q, N, increasing.
        currents: [n] A.
    """

    damping: Number
    forces: Float[Array, "*batch n"]
    currents: Float[Array, "*batch n"]

    def start(self) -> tuple[()]:
        """Nothing."""
        return ()

    def command(
        self, memory: tuple[()], sensed: Sensed, period: Number
    ) -> tuple[tuple[()], Number]:
        """Read the table at the wanted force; beyond its ends its ends hold."""
        wanted = along(demand(self.damping, sensed), sensed)
        current = self.currents[0] + 0.0 * wanted
        for k in range(self.forces.shape[-1] - 1):
            width = self.forces[k + 1] - self.forces[k]
            share = jnp.clip((wanted - self.forces[k]) / width, 0.0, 1.0)
            current = current + share * (self.currents[k + 1] - self.currents[k])
        return memory, jnp.where(dissipative(sensed), current, 0.0)


def schedule(
    currents: tuple[float, ...], yielding: np.ndarray, post: np.ndarray, speed: float = SPEED
) -> tuple[np.ndarray, np.ndarray]:
    """Forces and currents of a table.

    Args:
        currents: [n] A, increasing.
        yielding: [n] F_y at each, N.
        post: [n] C_post at each, N·s/m.
        speed: v_p, m/s.

    Returns:
        [m] N and [m] A.

    Raises:
        DataError: The force does not rise with current, so it cannot be inverted.
    """
    force = np.asarray(yielding) + np.asarray(post) * speed
    if force.size < 2 or np.any(np.diff(force) <= 0.0):
        listed = ", ".join(f"{z:.4g}" for z in force)
        raise DataError(
            f"gain scheduling needs a force that rises with current; at {speed:g} m/s the card's "
            f"currents give {listed} N",
            advice="Leave gain scheduling out, or give a card with two currents or more",
        )
    return force, np.asarray(currents)
