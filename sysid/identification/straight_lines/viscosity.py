"""C_post: the slope of the force/velocity response after yield."""

from sysid.data.loops import Loops
from sysid.identification.straight_lines.post_yield import post_yield_lines
from sysid.identification.straight_lines.stage import Found
from sysid.identification.straight_lines.windows import Window


def measure_viscosity(loops: Loops, n: int, window: Window) -> Found | str:
    """Post-yield viscosity C_post of one loop, N·s/m: mean slope of both directions.

    Args:
        loops: Of the campaign; the paper takes the fastest, 10 mm at 8 Hz.
        n: Which loop.
        window: In parts of peak speed.

    Source:
        C. K. Batterbee, N. D. Sims, Temperature sensitive controller performance of MR dampers,
        J. Intell. Mater. Syst. Struct. 20 (2009), section 3.  The window is not in the paper.
    """
    lines = post_yield_lines(loops, n, window)
    if isinstance(lines, str):
        return lines
    if not lines.slope.min() > 0.0:
        return "force falls with speed after yield, so its slope is no viscosity"
    first, second = lines.slope.tolist()
    cycles = lines.cycle_slope.mean(axis=1)
    return Found(0.5 * (first + second), 0.5 * (first - second), cycles, lines.offset, lines.used)
