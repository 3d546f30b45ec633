"""F_y: where the line through the data after yield meets zero velocity."""

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.straight_lines.post_yield import post_yield_lines
from sysid.identification.straight_lines.stage import Found
from sysid.identification.straight_lines.windows import Window


def measure_yield_force(loops: Loops, n: int, window: Window) -> Found | str:
    """Yield force F_y of one loop, N.

    The offset, what the gas of the accumulator and the load cell add, is half the sum of both
    intercepts; with it removed both directions agree, so F_y is half their difference.

    Args:
        loops: Of the campaign; the paper takes slow ones, 5 mm at 4 Hz.
        n: Which loop.
        window: In parts of peak speed.

    Source:
        C. K. Batterbee, N. D. Sims, Temperature sensitive controller performance of MR dampers,
        J. Intell. Mater. Syst. Struct. 20 (2009), section 3.  The window is not in the paper.
    """
    lines = post_yield_lines(loops, n, window)
    if isinstance(lines, str):
        return lines
    first, second = lines.intercept.tolist()
    if not first > second:
        return "the line after yield meets zero velocity at no force that resists motion"
    cycles = 0.5 * (lines.cycle_intercept @ np.array([1.0, -1.0]))
    return Found(0.5 * (first - second), np.nan, cycles, lines.offset, lines.used)
