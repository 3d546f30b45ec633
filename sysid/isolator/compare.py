"""What a conflict diagram says: changes with temperature, rivals at equal working space."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.stats import t as student

from sysid.isolator.study import ConflictDiagram, Curve

LEVEL: Final = 0.95
PLACES: Final = 21
"""Working spaces at which curves are compared."""


@dataclass(frozen=True)
class Band:
    """A mean over base motions.

    Attributes:
        value: The mean.
        low: Lower end of its 95 % interval, after Student.
        high: Upper end.
        single_low: Where single motions of 5 s begin: their 2.5 % quantile.
        single_high: Their 97.5 % quantile.
    """

    value: float
    low: float
    high: float
    single_low: float
    single_high: float


@dataclass(frozen=True)
class Change:
    """Of one controller at one set point, from one variant to another, as parts of the first.

    Attributes:
        name: Of the controller.
        set_point: D or current.
        acceleration: Of RMS acceleration.
        working_space: Of RMS working space.
    """

    name: str
    set_point: float
    acceleration: Band
    working_space: Band


@dataclass(frozen=True)
class Rival:
    """RMS acceleration of one controller over that of another at equal working space, less 1.

    Attributes:
        name: Of the controller.
        over: Of the other one.
        excess: Mean over the working spaces that both reach.
        spaces: First and last of them, m.
    """

    name: str
    over: str
    excess: Band
    spaces: tuple[float, float]


def band(values: np.ndarray) -> Band:
    """Mean over motions, and how well it is known; [motions].  NaN where one ran away."""
    mean, count = float(np.mean(values)), values.size
    low, high = (float(z) for z in np.quantile(values, [0.5 - LEVEL / 2, 0.5 + LEVEL / 2]))
    if count < 2:
        return Band(mean, -np.inf, np.inf, low, high)
    half = float(student.ppf(0.5 + LEVEL / 2, count - 1) * np.std(values, ddof=1) / count**0.5)
    return Band(mean, mean - half, mean + half, low, high)


def nearest(set_points: Sequence[float], wanted: float) -> int:
    """Index of the set point nearest to a wanted one."""
    return int(np.argmin(np.abs(np.asarray(set_points) - wanted)))


def change(curve: Curve, set_point: float, begin: int, end: int) -> Change:
    """What a change of the damper makes of a controller, motion by motion.

    Args:
        curve: Of the controller.
        set_point: The nearest one there is.
        begin: Index of the first variant.
        end: Index of the other.
    """
    at = nearest(curve.set_points, set_point)
    ratios = [z[at, end] / z[at, begin] - 1.0 for z in (curve.acceleration, curve.working_space)]
    return Change(curve.name, curve.set_points[at], *(band(z) for z in ratios))


def rival(diagram: ConflictDiagram, name: str, over: str, variant: int) -> Rival | None:
    """Two controllers at equal working space, motion by motion.

    Curves of single motions are read as lines between their set points, over the working spaces
    that both reach.

    Returns:
        None where the curves of some motion share no working space, or one ran away.
    """
    one, other = diagram.curve(name), diagram.curve(over)
    found, ends = [], []
    for motion in range(one.acceleration.shape[2]):
        curves = [_sorted(z, variant, motion) for z in (one, other)]
        if not all(space.size for space, _ in curves):
            return None
        low = max(space[0] for space, _ in curves)
        high = min(space[-1] for space, _ in curves)
        if not low < high:
            return None
        at = np.linspace(low, high, PLACES)
        mine, theirs = (np.interp(at, *curve) for curve in curves)
        found.append(float(np.mean(mine / theirs)) - 1.0)
        ends.append((low, high))
    first, last = np.mean(ends, axis=0).tolist()
    return Rival(name, over, band(np.asarray(found)), (first, last))


def _sorted(curve: Curve, variant: int, motion: int) -> tuple[np.ndarray, np.ndarray]:
    space = curve.working_space[:, variant, motion]
    order = np.argsort(space)
    order = order[np.isfinite(space[order])]
    return space[order], curve.acceleration[order, variant, motion]
