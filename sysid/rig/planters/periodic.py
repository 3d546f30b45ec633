"""Periodic solutions: linear equations along a loop, series of harmonics, shifts in time."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Complex, Float

Grid = Float[np.ndarray, "loop phase"]
PerLoop = Float[np.ndarray, " loop"]


def periodic_recurrence(factor: Grid, addend: Grid) -> Grid:
    """The periodic z with z_{j+1} = factor_j z_j + addend_j.

    Args:
        factor: [L, P], product over a cycle below 1.
        addend: [L, P].

    Returns:
        z_0 … z_{P−1}, [L, P].
    """
    points = factor.shape[1]
    rows_factor, rows_addend = np.ascontiguousarray(factor.T), np.ascontiguousarray(addend.T)
    z = np.zeros(factor.shape[0])
    for a, b in zip(rows_factor, rows_addend, strict=True):
        z = a * z + b
    z = z / (1.0 - np.prod(rows_factor, axis=0))
    path = np.empty_like(rows_factor)
    for j in range(points):
        path[j] = z
        z = rows_factor[j] * z + rows_addend[j]
    return path.T.copy()


def through(
    signal: Grid,
    frequency: PerLoop,
    response: Callable[[Float[np.ndarray, "loop order"]], Complex[np.ndarray, "loop order"]],
) -> Grid:
    """A periodic signal after a linear system.

    Args:
        signal: [L, P].
        frequency: Of the fundamental, [L] Hz.
        response: Circular frequency, [L, orders] rad/s → complex gain.
    """
    points = signal.shape[1]
    orders = np.arange(points // 2 + 1)
    gain = response(2.0 * np.pi * frequency[:, None] * orders)
    return np.fft.irfft(np.fft.rfft(signal, axis=1) * gain, points, axis=1)


def shifted(signal: Grid, steps: PerLoop) -> Grid:
    """A signal resampled later: y_j = s(j − steps), cubic through the four nearest samples.

    Args:
        signal: [L, P], periodic.
        steps: [L] samples, of either sign.
    """
    points = signal.shape[1]
    whole = np.floor(steps)
    t = (steps - whole)[:, None]
    index = (np.arange(points) - whole.astype(np.int64)[:, None]) % points
    weights = (
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    )
    total = np.zeros_like(signal)
    for weight, back in zip(weights, (-1, 0, 1, 2), strict=True):
        total += weight * np.take_along_axis(signal, (index - back) % points, axis=1)
    return total
