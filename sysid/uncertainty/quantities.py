"""What people read off a force: dissipated energy, peak, force at standstill."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.motion.motion import Motion
from sysid.uncertainty.standstill import standstills

Reading = Callable[[Float[np.ndarray, "draw loop point"], Motion], Float[np.ndarray, "draw loop"]]


@dataclass(frozen=True)
class Quantity:
    """A number that follows from the force on a motion.

    Attributes:
        name: In words.
        unit: SI.
        read: (forces [draw, loop, point] N, motion [loop, point]) → [draw, loop].
    """

    name: str
    unit: str
    read: Reading


def dissipated(
    force: Float[np.ndarray, "draw loop point"], motion: Motion
) -> Float[np.ndarray, "draw loop"]:
    """∮ F v dt, J: of one cycle, or of the whole record where the motion is not periodic."""
    power = force * np.asarray(motion.velocity)
    if motion.periodic:
        return power.mean(axis=2) / np.asarray(motion.frequency)[:, 0]
    return np.trapezoid(power, np.asarray(motion.time), axis=-1)


def peak(
    force: Float[np.ndarray, "draw loop point"], motion: Motion
) -> Float[np.ndarray, "draw loop"]:
    """Max |F|, N."""
    return np.abs(force).max(axis=2)


def at_standstill(
    force: Float[np.ndarray, "draw loop point"], motion: Motion
) -> Float[np.ndarray, "draw loop"]:
    """Half the height of the loop at standstill, N.

    F where v falls through 0 less F where it rises, over two (`standstill`); means of several such
    places, NaN without both kinds.
    """
    v, periodic = np.asarray(motion.velocity), motion.periodic
    high, low = (standstills(v, periodic=periodic, falling=falling) for falling in (True, False))
    return 0.5 * (high.mean(force) - low.mean(force))


ENERGY: Final = Quantity("dissipated energy", "J", dissipated)
PEAK: Final = Quantity("peak force", "N", peak)
STANDSTILL: Final = Quantity("half height of the loop at standstill", "N", at_standstill)
QUANTITIES: Final = (ENERGY, PEAK, STANDSTILL)
