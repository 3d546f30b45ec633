"""The knee of an f–v loop: from the steep pre-yield to the flat post-yield part.

Velocity is that of the fundamental, v = v_m u with u = cos φ, so that all loops share one grid of
u.  Each branch (accelerating, decelerating) is shifted to its own crossing of the middle force;
then both branches and both directions are averaged into one curve G(s), s = distance in velocity.
The post-yield line is fitted over the upper half of s; with its intercept F_y and slope C_post, and
the secant C_pre from the origin to where G = F_y/2, the knee is where they meet,

    v_knee = F_y / (C_pre − C_post).

For G = F_y tanh(b v) this is 2·artanh(1/2)/b = 1.0986/b; for a bi-viscous element it is v_y.
Where hysteresis leaves less than half of v_m to both branches, or nearly all force is viscous, no
knee can be told.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

HALF_GRID = 400
LINE_FROM = 0.5
LEAST_REACH = 0.5
LEAST_YIELD = 0.02
"""Share of yield force in the largest force below which an f–v curve counts as straight."""

PerLoop = Float[np.ndarray, " loop"]
OnBranch = Float[np.ndarray, "loop velocity"]


@dataclass(frozen=True)
class Branches:
    """Force of both branches of loops over u = v/v_m from −1 to 1, evenly.

    Attributes:
        rising: [L, 2·HALF_GRID + 1] N, velocity increasing (ẍ > 0).
        falling: [L, 2·HALF_GRID + 1] N, velocity decreasing (ẍ < 0).
    """

    rising: OnBranch
    falling: OnBranch

    def rising_at(self, u: PerLoop | float) -> PerLoop:
        """Force on the rising branch at v = u v_m."""
        return _at(self.rising, np.broadcast_to(u, self.rising.shape[:1])[:, None])[:, 0]

    def falling_at(self, u: PerLoop | float) -> PerLoop:
        """Force on the falling branch at v = u v_m."""
        return _at(self.falling, np.broadcast_to(u, self.falling.shape[:1])[:, None])[:, 0]


@dataclass(frozen=True)
class Knees:
    """Knee of each loop, [L]: m/s, N, N·s/m, and the share of yield force; NaN without one."""

    velocity: PerLoop
    yield_force: PerLoop
    pre_yield_damping: PerLoop
    post_yield_damping: PerLoop
    yield_share: PerLoop


def branches(force: Float[np.ndarray, "loop phase"]) -> Branches:
    """Split loops on the phase grid into branches over velocity.

    Args:
        force: [L, J] N, φ_j = 2πj/J, v = v_m cos φ.
    """
    u = np.linspace(-1.0, 1.0, 2 * HALF_GRID + 1)
    falling = np.arccos(u)
    return Branches(
        rising=_at_phase(force, 2.0 * np.pi - falling), falling=_at_phase(force, falling)
    )


def zero_crossing(branch: OnBranch) -> PerLoop:
    """U at which a branch's force is zero, the one nearest rest if several; NaN if none."""
    u = np.linspace(-1.0, 1.0, branch.shape[1])
    left, right = branch[:, :-1], branch[:, 1:]
    crosses = (left * right <= 0.0) & (left != right)
    part = np.divide(left, left - right, out=np.zeros_like(left), where=crosses)
    place = np.where(crosses, u[:-1] + part * (u[1] - u[0]), np.inf)
    best = np.take_along_axis(place, np.argmin(np.abs(place), axis=1)[:, None], axis=1)[:, 0]
    return np.where(np.isfinite(best), best, np.nan)


def find_knees(sides: Branches, peak_velocity: PerLoop) -> Knees:
    """Knee, yield force and post-yield line of each loop.

    Args:
        sides: Branches of L loops.
        peak_velocity: [L] m/s.
    """
    curve, reach = _symmetric_curve(sides)
    s = np.linspace(0.0, 1.0, curve.shape[1])
    line = s >= LINE_FROM
    slope, intercept = _straight_line(s[line], curve[:, line])
    end = slope + intercept
    share = np.divide(intercept, end, out=np.full_like(end, np.nan), where=end > 0.0)
    half = _first_reach(s, curve, 0.5 * intercept)
    stretch = peak_velocity * reach
    with np.errstate(divide="ignore", invalid="ignore"):
        before = 0.5 * intercept / (half * stretch)
        after = slope / stretch
        knee = intercept / (before - after)
    told = reach >= LEAST_REACH
    good = told & (share > LEAST_YIELD) & (before > after)
    return Knees(
        velocity=np.where(good, knee, np.nan),
        yield_force=np.where(told, intercept, np.nan),
        pre_yield_damping=np.where(good, before, np.nan),
        post_yield_damping=np.where(told, after, np.nan),
        yield_share=np.where(told, share, np.nan),
    )


def _symmetric_curve(sides: Branches) -> tuple[OnBranch, PerLoop]:
    """G(s) with s from 0 to 1, and the velocity (in v_m) that s = 1 stands for."""
    middle = 0.5 * (sides.rising + sides.falling)
    level = 0.5 * (middle.max(axis=1) + middle.min(axis=1))[:, None]
    rising, falling = sides.rising - level, sides.falling - level
    at_rising, at_falling = zero_crossing(rising), zero_crossing(falling)
    reach = 1.0 - np.fmax(np.abs(at_rising), np.abs(at_falling))
    s = np.linspace(0.0, 1.0, HALF_GRID + 1) * reach[:, None]
    up, down = at_rising[:, None], at_falling[:, None]
    ahead = _at(rising, up + s) + _at(falling, down + s)
    behind = _at(rising, up - s) + _at(falling, down - s)
    return 0.25 * (ahead - behind), reach


def _straight_line(x: Float[np.ndarray, " n"], y: OnBranch) -> tuple[PerLoop, PerLoop]:
    """Slope and intercept of each row by least squares."""
    dx = x - x.mean()
    slope = (y @ dx) / float(dx @ dx)
    return slope, y.mean(axis=1) - slope * x.mean()


def _first_reach(s: Float[np.ndarray, " n"], curve: OnBranch, level: PerLoop) -> PerLoop:
    """First s at which each row reaches its level; NaN if it does not."""
    above = curve >= level[:, None]
    k = np.maximum(np.argmax(above, axis=1), 1)
    rows = np.arange(curve.shape[0])
    low, high = curve[rows, k - 1], curve[rows, k]
    rise = np.where(high > low, high - low, np.nan)
    place = s[k - 1] + (level - low) / rise * (s[1] - s[0])
    return np.where(above.any(axis=1), place, np.nan)


def _at(branch: OnBranch, u: Float[np.ndarray, "loop m"]) -> Float[np.ndarray, "loop m"]:
    """Linear interpolation of each row at its own u; NaN for NaN."""
    known = np.isfinite(u)
    place = np.clip((np.where(known, u, 0.0) + 1.0) * HALF_GRID, 0.0, 2.0 * HALF_GRID - 1e-9)
    k = place.astype(np.int64)
    part = place - k
    low = np.take_along_axis(branch, k, axis=1)
    high = np.take_along_axis(branch, k + 1, axis=1)
    return np.where(known, low + part * (high - low), np.nan)


def _at_phase(
    force: Float[np.ndarray, "loop phase"], phase: Float[np.ndarray, " velocity"]
) -> OnBranch:
    """Periodic linear interpolation of every row at common phases."""
    points = force.shape[1]
    place = phase * (points / (2.0 * np.pi))
    k = np.floor(place).astype(np.int64)
    part = place - k
    return force[:, k % points] * (1.0 - part) + force[:, (k + 1) % points] * part
