"""What a hysteresis loop shows at a glance, as numbers to start a fit from.

Rough on purpose: every feature is defined for every loop, also for one that never saturates, and
nothing but start values rests on them.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops

PerLoop = Float[np.ndarray, " loop"]


@dataclass(frozen=True)
class LoopFeatures:
    """Features of L loops.

    Attributes:
        plateau: [L] N, mean |F − offset| where |v| exceeds 0.7 v_m.
        offset: [L] N, half the sum of the mean forces at high speed in both directions.
        width: [L] v_h/v_m, half the distance between the zero-force velocities of the two
            branches over v_m; negative where force lags velocity (W11 Eq. 7, k_4 < 0).
        slope: [L] N·s/m, dF/dv where the force passes its offset.
        rise: [L, 2] s/m, relative rise of |F| with |v| at high speed, compression and rebound.
        peak_velocity: [L] m/s.
        current: [L] A.
        stiffness: [L] N/m, dF/dx where the force passes its offset after a reversal.
        temperature: [L] °C; NaN where not known.
    """

    plateau: PerLoop
    offset: PerLoop
    width: PerLoop
    slope: PerLoop
    rise: Float[np.ndarray, "loop 2"]
    peak_velocity: PerLoop
    current: PerLoop
    stiffness: PerLoop
    temperature: PerLoop


def loop_features(loops: Loops) -> LoopFeatures:
    """Read plateau, offset, width, slope and rise off every loop at once."""
    v_m = loops.peak_velocity
    s = loops.velocity / v_m[:, None]
    fast = np.abs(s) > 0.7
    forward = _masked_mean(loops.force, fast & (s > 0))
    backward = _masked_mean(loops.force, fast & (s < 0))
    offset, plateau = 0.5 * (forward + backward), np.abs(0.5 * (forward - backward))
    centred = loops.force - offset[:, None]
    up, down = _crossings(s, centred)
    rise = np.stack(
        [_relative_rise(np.abs(s), np.abs(centred), fast & side) for side in (s > 0, s < 0)], axis=1
    )
    return LoopFeatures(
        plateau=plateau,
        offset=offset,
        # on the branch where v grows (ẍ > 0) the force passes zero at −v_h
        width=-0.5 * (up[0] - down[0]),
        slope=0.5 * (up[1] + down[1]) / v_m,
        rise=rise / v_m[:, None],
        peak_velocity=v_m,
        current=loops.current,
        stiffness=_unloading(loops.displacement, centred, plateau),
        temperature=loops.temperature,
    )


def _masked_mean(values: np.ndarray, mask: np.ndarray) -> PerLoop:
    return np.where(mask, values, 0.0).sum(axis=1) / np.maximum(mask.sum(axis=1), 1)


def _crossings(s: np.ndarray, force: np.ndarray) -> list[tuple[PerLoop, PerLoop]]:
    """(velocity, slope) at the zero of a line through the low-force points of each branch.

    The branches are the half cycles of growing and of falling velocity; a line v(F) through the
    points with the 25 % smallest |F| of a branch is defined for every loop.
    """
    result = []
    points = s.shape[1]
    phase = np.arange(points)
    rising = phase >= points // 2  # x₁ < 0, so ẍ > 0
    for half in (rising, ~rising):
        v, f = s[:, half], force[:, half]
        small = np.abs(f) <= np.quantile(np.abs(f), 0.25, axis=1)[:, None]
        w = small / small.sum(axis=1, keepdims=True)
        v_0, f_0 = (w * v).sum(axis=1), (w * f).sum(axis=1)
        dv, df = v - v_0[:, None], f - f_0[:, None]
        per_force = (w * dv * df).sum(axis=1) / np.maximum((w * df * df).sum(axis=1), 1e-30)
        per_force = np.maximum(per_force, 1e-3 / np.maximum(np.abs(f).max(axis=1), 1e-30))
        result.append((np.clip(v_0 - per_force * f_0, -1.0, 1.0), 1.0 / per_force))
    return result


def _unloading(x: np.ndarray, force: np.ndarray, plateau: PerLoop) -> PerLoop:
    """Slope of a line F(x) through the points of each reversal below 0.4 plateaus, their mean.

    Where these are fewer than two, of the chord that passes zero.
    """
    points = x.shape[1]
    trough = np.arange(points) >= points // 2
    found = []
    for half in (trough, ~trough):
        travel, f = x[:, half], force[:, half]
        k = np.argmax(f[:, :-1] * f[:, 1:] <= 0.0, axis=1)[:, None]
        low = np.abs(f) < 0.4 * plateau[:, None]
        place = np.arange(f.shape[1])
        low |= (place == k) | (place == k + 1)
        w = low / low.sum(axis=1, keepdims=True)
        dx = travel - (w * travel).sum(axis=1, keepdims=True)
        found.append((w * dx * f).sum(axis=1) / np.maximum((w * dx * dx).sum(axis=1), 1e-30))
    return np.maximum(0.5 * (found[0] + found[1]), 1e-30)


def _relative_rise(speed: np.ndarray, force: np.ndarray, mask: np.ndarray) -> PerLoop:
    """κ of |F| ∝ 1 + κ|v|/v_m by a line through the masked points."""
    n = np.maximum(mask.sum(axis=1), 1)
    x_0 = np.where(mask, speed, 0.0).sum(axis=1) / n
    y_0 = np.where(mask, force, 0.0).sum(axis=1) / n
    dx = np.where(mask, speed - x_0[:, None], 0.0)
    slope = (dx * force).sum(axis=1) / np.maximum((dx * dx).sum(axis=1), 1e-30)
    intercept = np.maximum(y_0 - slope * x_0, 0.1 * np.abs(y_0) + 1e-30)
    return np.clip(slope / intercept, 0.01, 10.0)
