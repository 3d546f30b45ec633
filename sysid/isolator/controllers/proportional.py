"""Proportional skyhook control with force feedback."""

from typing import Final

import jax.numpy as jnp

from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.plant import Number
from sysid.isolator.skyhook import Sensed, along, demand, dissipative

FEEDBACK: Final = 0.6
"""B of BS09."""
FEEDFORWARD: Final = 0.0012
"""G of BS09, A/N."""


class Proportional(AbstractController):
    """I = G (F_d − B F) in the direction of motion (BS09 Eq. 4), 0 by Eq. 2.

    Attributes:
        damping: D, N·s/m.
        feedback: B.
        feedforward: G, A/N.
    """

    damping: Number
    feedback: Number
    feedforward: Number

    def start(self) -> tuple[()]:
        """Nothing."""
        return ()

    def command(
        self, memory: tuple[()], sensed: Sensed, period: Number
    ) -> tuple[tuple[()], Number]:
        """Feedback linearisation."""
        wanted = along(demand(self.damping, sensed) - self.feedback * sensed.force, sensed)
        return memory, jnp.where(dissipative(sensed), self.feedforward * wanted, 0.0)


def proportional(
    damping: Number, feedback: float = FEEDBACK, feedforward: float = FEEDFORWARD
) -> Proportional:
    """With the paper's gains unless told otherwise."""
    return Proportional(damping, jnp.asarray(feedback), jnp.asarray(feedforward))
