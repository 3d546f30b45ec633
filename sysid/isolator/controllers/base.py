"""What a controller of a damper's current is."""

from abc import abstractmethod
from typing import Any

import equinox as eqx

from sysid.isolator.plant import Number
from sysid.isolator.skyhook import Sensed


class AbstractController(eqx.Module):
    """A sampled controller: a current for every sample, held until the next one."""

    @abstractmethod
    def start(self) -> Any:
        """Its memory before the first sample."""

    @abstractmethod
    def command(self, memory: Any, sensed: Sensed, period: Number) -> tuple[Any, Number]:
        """Memory after a sample, and the current, A; the loop limits it to what the card knows.

        Args:
            memory: After the sample before.
            sensed: What is measured.
            period: Between samples, s.
        """
