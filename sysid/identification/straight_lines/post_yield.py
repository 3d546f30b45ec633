"""The decelerating force/velocity data after yield, and the line through each direction."""

from typing import NamedTuple

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.straight_lines.stage import FEWEST, slope_and_intercept
from sysid.identification.straight_lines.windows import Window


class PostYield(NamedTuple):
    """Lines F = slope·v + intercept, compression first.

    Attributes:
        slope: [2] N·s/m.
        intercept: [2] N.
        cycle_slope: [cycles, 2] N·s/m.
        cycle_intercept: [cycles, 2] N.
        used: [J] points in either window.
    """

    slope: np.ndarray
    intercept: np.ndarray
    cycle_slope: np.ndarray
    cycle_intercept: np.ndarray
    used: np.ndarray

    @property
    def offset(self) -> float:
        """N, about which the zero-velocity intercepts of both directions are symmetric."""
        return float(self.intercept.mean())


def decelerating(loops: Loops, n: int, side: int, window: Window) -> np.ndarray:
    """Points of a loop in one direction of motion whose speed falls.

    Deceleration is that of the fundamental, the quarter cycle before each reversal: the sign of
    a measured acceleration flickers with the harmonics of an actuator.

    Args:
        loops: Of the campaign.
        n: Which loop.
        side: 1 compression, −1 extension.
        window: In parts of the peak velocity Aω.

    Returns:
        [J] booleans.
    """
    points = loops.velocity.shape[1]
    turn = np.arange(points) / points - (0.0 if side > 0 else 0.5)
    share = side * loops.velocity[n] / loops.peak_velocity[n]
    return (turn >= 0.0) & (turn < 0.25) & (share > window.low) & (share < window.high)


def post_yield_lines(loops: Loops, n: int, window: Window) -> PostYield | str:
    """Straight lines through the decelerating force/velocity data of one loop.

    Only decelerating data, so that the inertia of the fluid, which rings after each reversal,
    has died away.

    Returns:
        The lines, or why there are none.
    """
    lines, cycles, used = [], [], []
    cycle_force = loops.force[n] + loops.deviations[n]
    for side in (1, -1):
        kept = decelerating(loops, n, side, window)
        if kept.sum() < FEWEST:
            return (
                f"{int(kept.sum())} of the {kept.size} points of the loop lie at {window} of peak "
                f"speed, decelerating; a line needs {FEWEST}"
            )
        v = loops.velocity[n, kept]
        lines.append(slope_and_intercept(v, loops.force[n, kept]))
        cycles.append(slope_and_intercept(v, cycle_force[:, kept]))
        used.append(kept)
    slope, intercept = np.array(lines).T
    cycle_slope, cycle_intercept = np.array(cycles).transpose(1, 2, 0)
    return PostYield(slope, intercept, cycle_slope, cycle_intercept, used[0] | used[1])
