"""The lumped model with one of its laws bent over temperature."""

from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.models.base import AbstractModel
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.lumped import Degrees, Lumped, Warmth, element_force
from sysid.models.lumped_coordinates import LumpedCoordinates
from sysid.motion.motion import Motion

BENT_LAWS: Final = ("C_post", "F_y", "k")
_STRAIGHT: Final = 1e-3
"""A bend below which the series about zero is more exact than the quotient."""


class BentLumped(AbstractModel):
    r"""Lines in temperature, read on a bent scale of temperature.

        T ← T_c + (T_w − T_c) (1 − e^{−b s}) / (1 − e^{−b}),    s = (T − T_c)/(T_w − T_c)

    with a b of its own for C_post, F_y and k.  A law and its table keep their values at the coldest
    and warmest temperature, T_c and T_w, and rise and fall with current as before; with b > 0 most
    of the change happens where it is cold, as with a viscosity after Arrhenius or Vogel; b = 0 is
    the straight line.

    Attributes:
        straight: Currents, values at both ends, and everything else.
        bends: [3] b of C_post, F_y, k.
        cold: T_c, °C.
        warm: T_w, °C.
    """

    straight: Lumped
    bends: Float[Array, "3"]
    cold: Scalar
    warm: Scalar

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N, positive when it resists compression."""
        return element_force(self.straight.element(motion, self._warped), motion)

    def _warped(self, warm: Degrees) -> Warmth:
        share = (warm - self.cold) / (self.warm - self.cold)
        return Warmth(*(self.cold + (self.warm - self.cold) * bent(share, b) for b in self.bends))


def bent(share: Float[Array, "..."], bend: Scalar) -> Float[Array, "..."]:
    """(1 − e^{−b s}) / (1 − e^{−b}); s where b is zero."""
    small = jnp.abs(bend) < _STRAIGHT
    b = jnp.where(small, 1.0, bend)
    series = share + bend * share * (1.0 - share) / 2.0
    return jnp.where(small, series, jnp.expm1(-b * share) / jnp.expm1(-b))


class BentCoordinates(AbstractCoordinates[BentLumped]):
    """Those of the straight model, then one bend.

    Attributes:
        straight: Coordinates of the straight model.
        which: [3] 1 for the law that bends, else 0; all 0 for none, when the last coordinate does
            nothing.
    """

    straight: LumpedCoordinates
    which: Float[Array, "3"]

    @property
    def size(self) -> int:
        """One more."""
        return self.straight.size + 1

    @property
    def free(self) -> tuple[str, ...]:
        """Symbols of the straight model, and the bend."""
        return (*self.straight.free, "bend")

    @property
    def ties(self) -> tuple[tuple[str, str], ...]:
        """None."""
        return ()

    @property
    def statics_free(self) -> bool:
        """As with straight lines."""
        return self.straight.statics_free

    def valve(self, u: Float[Array, " n"]) -> BentLumped:
        """The model at u."""
        lines = self.straight.valve(u[:-1])
        return BentLumped(lines, self.which * u[-1], self.straight.cold, self.straight.warm)

    def locate(self, valve: BentLumped) -> Float[Array, " n"]:
        """Coordinates of a model."""
        bend = jnp.sum(self.which * valve.bends)
        return jnp.concatenate([self.straight.locate(valve.straight), bend[None]])
