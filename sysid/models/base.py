"""What every valve model is."""

from abc import abstractmethod

import equinox as eqx
from jaxtyping import Array, Float

from sysid.motion.motion import Motion


class AbstractValve(eqx.Module):
    """A damper's valve: force from motion, current and temperature."""

    @abstractmethod
    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Force at every point of the motion, N, positive when it resists compression."""
