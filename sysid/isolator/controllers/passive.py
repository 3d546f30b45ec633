"""No control."""

from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.plant import Number
from sysid.isolator.skyhook import Sensed


class Passive(AbstractController):
    """A constant current.

    Attributes:
        current: A.
    """

    current: Number

    def start(self) -> tuple[()]:
        """Nothing."""
        return ()

    def command(
        self, memory: tuple[()], sensed: Sensed, period: Number
    ) -> tuple[tuple[()], Number]:
        """The same at every sample."""
        return memory, self.current + 0.0 * sensed.force
