"""What people read off a force: dissipated energy, peak, force at standstill."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.motion.motion import Motion

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

    F where v falls through 0 less F where it rises, over two; means of several such places, NaN
    without both kinds.
    """
    v = np.asarray(motion.velocity)
    after = np.roll(v, -1, axis=1)
    later = np.roll(force, -1, axis=2)
    if not motion.periodic:
        v, after, force, later = v[:, :-1], after[:, :-1], force[:, :, :-1], later[:, :, :-1]
    share = np.where(v != after, v / np.where(v != after, v - after, 1.0), 0.0)
    between = (1.0 - share) * force + share * later
    falling, rising = (v > 0.0) & (after <= 0.0), (v < 0.0) & (after >= 0.0)
    return 0.5 * (_mean(between, falling) - _mean(between, rising))


def _mean(values: np.ndarray, where: np.ndarray) -> np.ndarray:
    count = where.sum(axis=1)
    return np.where(count > 0, np.sum(values * where, axis=2) / np.maximum(count, 1), np.nan)


ENERGY: Final = Quantity("dissipated energy", "J", dissipated)
PEAK: Final = Quantity("peak force", "N", peak)
STANDSTILL: Final = Quantity("half height of the loop at standstill", "N", at_standstill)
QUANTITIES: Final = (ENERGY, PEAK, STANDSTILL)
