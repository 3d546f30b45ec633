"""What a damper must do to stand in a closed loop."""

from abc import abstractmethod
from typing import Any

import equinox as eqx
import jax

from sysid.isolator.implicit_stage import Port, onward
from sysid.isolator.plant import Number


class AbstractDamperStep(eqx.Module):
    """A damper at one temperature that advances with its plant.

    Attributes:
        tau: Time constant of current and fluid together, s.
        currents: A, at which gain scheduling reads its table, rising.
    """

    tau: eqx.AbstractVar[Number]
    currents: eqx.AbstractVar[tuple[float, ...]]

    @property
    def largest_current(self) -> float:
        """A; commands are limited to it."""
        return self.currents[-1]

    @abstractmethod
    def start(self) -> Any:
        """State at rest: a tuple of numbers, which the integrator combines linearly."""

    @abstractmethod
    def stage(self, known: Any, meets: Port, current: Number) -> tuple[Any, Number]:
        """State at the end of a stage, Y = K + g f(Y), and the force, N.

        Args:
            known: K, in the form of `start`.
            meets: The plant.
            current: What the fluid feels at the end of the stage, A.
        """

    def carried(self, begin: Any, first: Any) -> Any:
        """K of the second stage, in the form of `start`.

        Args:
            begin: y_n, at the start of the step.
            first: Y_1, at the end of the first stage.
        """
        return jax.tree.map(onward, begin, first)


class NoDamper(AbstractDamperStep):
    """Nothing: for plants that need no damper, as the ideal skyhook.

    Attributes:
        tau: Of no meaning.
        currents: Of no meaning, A.
    """

    tau: Number
    currents: tuple[float, ...] = eqx.field(static=True, default=(1.0,))

    def start(self) -> tuple[()]:
        """Nothing."""
        return ()

    def stage(self, known: tuple[()], meets: Port, current: Number) -> tuple[tuple[()], Number]:
        """No force."""
        return known, 0.0 * meets.velocity
