"""The gas of a damper's accumulator in an isolator."""

from dataclasses import dataclass

from sysid.isolator.closed_loop import Sensor


@dataclass(frozen=True)
class Gas:
    """A static force and a stiffness beside the valve.

    The static force is carried by the isolator's own spring, about whose equilibrium the plant is
    written, so no more of it is left than what a force sensor reads; the stiffness adds to the
    spring.

    Attributes:
        preload: N at the equilibrium.
        stiffness: N/m.
    """

    preload: float = 0.0
    stiffness: float = 0.0

    def sensor(self, removed: bool = False) -> Sensor:
        """What a force sensor at the damper reads beside the valve.

        Args:
            removed: The static force is taken off the reading.
        """
        return Sensor(0.0 if removed else self.preload, self.stiffness)
