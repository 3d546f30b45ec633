"""k: the slope of force against displacement where velocity changes sign."""

from typing import NamedTuple

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.straight_lines.post_yield import post_yield_lines
from sysid.identification.straight_lines.stage import FEWEST, Found, Measure, slope_and_intercept
from sysid.identification.straight_lines.windows import Window


class Unloading(NamedTuple):
    """The branch after one reversal.

    Attributes:
        points: [n] indices of the points in the window, in the order in which they are passed.
        reversal: N, force where velocity changes sign.
    """

    points: np.ndarray
    reversal: float


def stiffness_measure(yield_force: np.ndarray, own: Window) -> Measure:
    """The recipe for k, given how far the force falls after a reversal.

    Args:
        yield_force: [loops] N, F_y at each test's current and temperature; where NaN, the
            zero-velocity intercept of the test itself.
        own: Window of that intercept.
    """

    def measure(loops: Loops, n: int, window: Window) -> Found | str:
        return measure_stiffness(loops, n, window, float(yield_force[n]), own)

    return measure


def measure_stiffness(
    loops: Loops, n: int, window: Window, yield_force: float, own: Window
) -> Found | str:
    """Stiffness k of one loop, N/m: mean slope after both reversals.

    After a reversal the valve is shut, so the force falls with the spring's slope until the valve
    yields the other way, at −F_y.  The window is in parts of that way, beginning with the force
    at the reversal; both forces are counted from the offset of the loop.

    Args:
        loops: Of the campaign; the paper takes 10 mm at 8 Hz and high currents.
        n: Which loop.
        window: In parts of the way from the reversal to −F_y.
        yield_force: N; NaN: the loop's own intercept.
        own: Window of that intercept, and of the offset, in parts of peak speed.

    Source:
        C. K. Batterbee, N. D. Sims, Temperature sensitive controller performance of MR dampers,
        J. Intell. Mater. Syst. Struct. 20 (2009), section 3.  The window is not in the paper.
    """
    lines = post_yield_lines(loops, n, own)
    if isinstance(lines, str):
        return f"its offset is not known: {lines}"
    if not np.isfinite(yield_force):
        yield_force = 0.5 * float(lines.intercept[0] - lines.intercept[1])
    slopes, cycles = [], []
    used = np.zeros(loops.force.shape[1], dtype=bool)
    cycle_force = loops.force[n] + loops.deviations[n]
    cycle_displacement = loops.displacement[n] + loops.displacement_deviations[n]
    for side in (1, -1):
        branch = unloading(loops, n, side, window, lines.offset - side * yield_force)
        if branch is None:
            return "force does not fall towards −F_y after velocity changes sign"
        here = branch.points
        if here.size < FEWEST:
            return (
                f"{here.size} of the {used.size} points of the loop lie at {window} of the way "
                f"from the reversal to −F_y; a line needs {FEWEST}"
            )
        slopes.append(slope_and_intercept(loops.displacement[n, here], loops.force[n, here])[0])
        cycles.append(slope_and_intercept(cycle_displacement[:, here], cycle_force[:, here])[0])
        used[here] = True
    first, second = (float(s) for s in slopes)
    if not min(first, second) > 0.0:
        return "force does not fall with displacement where velocity changes sign"
    return Found(
        0.5 * (first + second), 0.5 * (first - second), np.mean(cycles, axis=0), lines.offset, used
    )


def unloading(loops: Loops, n: int, side: int, window: Window, end: float) -> Unloading | None:
    """The window's points after one reversal, up to where the force first leaves it.

    Args:
        loops: Of the campaign.
        n: Which loop.
        side: 1 after compression, −1 after extension.
        window: In parts of the way of the force.
        end: N, where the way ends: the offset minus `side`·F_y.
    """
    points = loops.force.shape[1]
    start = 0 if side > 0 else points // 2
    order = (start + np.arange(points)) % points
    still = side * loops.velocity[n, order[: points // 2]] > 0.0
    if still.all() or not still[points // 8]:
        return None
    # harmonics may make the velocity flicker far from the reversal: look from mid-quarter on
    after = points // 8 + int(np.argmin(still[points // 8 :]))
    v_before, v_after = loops.velocity[n, order[[after - 1, after]]]
    share = v_before / (v_before - v_after)
    f_before, f_after = loops.force[n, order[[after - 1, after]]]
    reversal = float(f_before + share * (f_after - f_before))
    if not side * (reversal - end) > 0.0:
        return None
    branch = order[after : after + points // 2]
    way = (reversal - loops.force[n, branch]) / (reversal - end)
    past = way >= window.high
    last = int(np.argmax(past)) if past.any() else past.size
    kept = np.flatnonzero((way > window.low) & (np.arange(way.size) < last))
    return Unloading(branch[kept], reversal)
