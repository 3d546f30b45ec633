"""Velocity and acceleration from a sampled displacement, on any increasing time grid."""

import numpy as np
from jaxtyping import Float
from scipy.interpolate import make_interp_spline
from scipy.linalg import solveh_banded

Samples = Float[np.ndarray, " n"]
Knots = Float[np.ndarray, " k"]

_ORDER = 3
"""Order of the differences that the smoother penalises."""
_SAME_TIME = 0.05
"""Parts of the usual step: stamps closer together than that are one sample to the smoother."""
_STIFF = 14.0
"""Power of ten of the largest number in the smoother's equations that are solved to any digits."""


def smooth_derivatives(time: Samples, values: Samples) -> tuple[Samples, Samples, Samples]:
    """Signal, first and second derivative of a whole record, by a quintic spline.

    The noise level is read off the sixth differences, which see noise but hardly any motion
    sampled 20 times a cycle or more.  The samples are smoothed by third differences just so much
    that what is taken away has that level (discrepancy principle); on clean data that is next to
    nothing.  A quintic spline through the result is differentiated exactly.  Of stamps closer
    together than a twentieth of the usual step the means are taken.

    Args:
        time: [n] s, strictly increasing, n ≥ 7.
        values: [n].

    Returns:
        Smoothed values, first derivative, second derivative, each [n].

    Source:
        E. T. Whittaker, On a new method of graduation, Proc. Edinburgh Math. Soc. 41 (1923);
        V. A. Morozov, On the solution of functional equations by regularization (1966).
    """
    scale = float(np.median(np.diff(time)))  # the mean is nobody's step where there is a gap
    t = (time - time[0]) / scale
    knots, y = _apart(t, values)
    smooth = _smooth(knots, y, _noise(knots, y))
    spline = make_interp_spline(knots, smooth, k=5)
    if knots.size < t.size:
        smooth = np.asarray(spline(t))
    first, second = spline.derivative(1)(t), spline.derivative(2)(t)
    return smooth, first / scale, second / scale**2


def causal_derivatives(time: Samples, values: Samples) -> tuple[Samples, Samples]:
    """First and second derivative from past samples only: three-point backward differences.

    Those of the parabola through the newest three samples, at the newest one.  On a uniform grid
    of step h,

        ẋ_n = (3 x_n − 4 x_{n−1} + x_{n−2}) / 2h,   ẍ_n = (x_n − 2 x_{n−1} + x_{n−2}) / h².

    Nothing is smoothed, and ẍ is late by one sample.  The first sample has ẋ = ẍ = 0, the second
    ẋ = (x_1 − x_0)/h and ẍ = 0.

    Args:
        time: [n] s, strictly increasing.
        values: [n].

    Returns:
        First and second derivative, each [n].
    """
    step = np.diff(time)
    slope = np.diff(values) / step
    first, second = np.zeros(values.size), np.zeros(values.size)
    if values.size > 1:
        first[1] = slope[0]
    curvature = (slope[1:] - slope[:-1]) / (step[1:] + step[:-1])
    first[2:] = slope[1:] + curvature * step[1:]
    second[2:] = 2.0 * curvature
    return first, second


def _apart(t: Samples, y: Samples) -> tuple[Knots, Knots]:
    """Samples with means in the place of those at next to the same time, if seven are left."""
    new = np.r_[True, np.diff(t) >= _SAME_TIME]
    if new.all() or np.count_nonzero(new) < 7:
        return t, y
    group = np.cumsum(new) - 1
    count = np.bincount(group)
    return np.bincount(group, t) / count, np.bincount(group, y) / count


def _divided_differences(t: Samples, order: int) -> Float[np.ndarray, "row k"]:
    """Rows of the operator Δ^order on a grid, scaled to plain differences where it is uniform."""
    rows = np.ones((t.size, 1))
    for k in range(1, order + 1):
        width = (t[k:] - t[:-k]) / k
        padded = np.zeros((t.size - k, k + 1))
        padded[:, 1:] += rows[1:]
        padded[:, :-1] -= rows[:-1]
        rows = padded / width[:, None]
    return rows


def _noise(t: Samples, y: Samples) -> float:
    """Standard deviation of white noise, from sixth differences (median, so jumps do not count)."""
    rows = _divided_differences(t, 6)
    windows = np.lib.stride_tricks.sliding_window_view(y, 7)
    seen = np.sum(rows * windows, axis=1) / np.sqrt(np.sum(rows**2, axis=1))
    return float(np.median(np.abs(seen)) / 0.6745)


def _smooth(t: Samples, y: Samples, noise: float) -> Samples:
    """Minimise Σ(y − z)² + λ Σ(Δ³z)², λ such that the RMS of y − z is `noise`."""
    rows = _divided_differences(t, _ORDER)
    gram = np.zeros((_ORDER + 1, t.size))
    for i in range(_ORDER + 1):
        for j in range(i, _ORDER + 1):
            diagonal = rows[:, i] * rows[:, j]
            gram[_ORDER - (j - i), j : j + diagonal.size] += diagonal

    def solve(log_penalty: float) -> Samples:
        banded = 10.0**log_penalty * gram
        banded[_ORDER] += 1.0
        return solveh_banded(banded, y, check_finite=False)

    low, high = -6.0, min(12.0, _STIFF - float(np.log10(gram.max())))
    if noise <= 1e-12 * float(np.ptp(y)):
        return y
    for _ in range(30):
        middle = 0.5 * (low + high)
        residual = float(np.sqrt(np.mean((y - solve(middle)) ** 2)))
        low, high = (middle, high) if residual < noise else (low, middle)
    return solve(low)
