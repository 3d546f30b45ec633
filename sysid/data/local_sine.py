"""Sinusoids fitted to sliding windows one period long: slowly varying amplitude and phase."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

WINDOWS_PER_PERIOD = 16

Samples = Float[np.ndarray, " n"]
Windows = Float[np.ndarray, " window"]


@dataclass(frozen=True)
class LocalSine:
    """x ≈ centre + amplitude·sin(ω (t − t₀) + lag), fitted to each window by least squares.

    Attributes:
        time: [w] s, middle of each window.
        centre: [w] m.
        amplitude: [w] m.
        lag: [w] rad, unwrapped, relative to ω (t − t₀) with t₀ the first sample's time.
        residual: [w] RMS of what the sinusoid leaves over the window, relative to the RMS of
            the sinusoid.
        frequency: [w] Hz, from the slope of the lag over one period.
    """

    time: Windows
    centre: Windows
    amplitude: Windows
    lag: Windows
    residual: Windows
    frequency: Windows

    def select(self, part: slice) -> "LocalSine":
        """The windows of a slice."""
        return LocalSine(
            self.time[part],
            self.centre[part],
            self.amplitude[part],
            self.lag[part],
            self.residual[part],
            self.frequency[part],
        )


def fit_local_sine(time: Samples, x: Samples, frequency: float) -> LocalSine:
    """Fit constant, sine and cosine to every window of one period, `WINDOWS_PER_PERIOD` a period.

    One more window ends with the record, or a record of whole cycles would lack part of its last.

    Sums over windows are differences of cumulative trapezoid integrals, so that a window need
    not hold a whole number of samples and sampling need not be uniform; as all products use the
    same weights, a pure sinusoid is found exactly.  A record shorter than that is one window.

    Args:
        time: [n] s, strictly increasing.
        x: [n] m.
        frequency: Hz, near the true one.
    """
    period = 1.0 / frequency
    t, y = time - time[0], x - np.mean(x)
    angle = 2.0 * np.pi * frequency * t
    c, s, one = np.cos(angle), np.sin(angle), np.ones_like(t)
    products = np.stack([one, s, c, s * s, s * c, c * c, y, y * s, y * c, y * y])
    steps = 0.5 * (products[:, 1:] + products[:, :-1]) * np.diff(t)
    sums = np.concatenate([np.zeros((products.shape[0], 1)), np.cumsum(steps, axis=1)], axis=1)
    middle = np.arange(0.5 * period, t[-1] - 0.5 * period * (1 - 1e-9), period / WINDOWS_PER_PERIOD)
    if middle.size == 0:
        middle = np.array([0.5 * t[-1]])
    elif t[-1] - 0.5 * period > middle[-1] + 1e-6 * period:
        middle = np.append(middle, t[-1] - 0.5 * period)
    window = np.stack(
        [
            np.interp(middle + 0.5 * period, t, row) - np.interp(middle - 0.5 * period, t, row)
            for row in sums
        ]
    )
    w, ws, wc, wss, wsc, wcc, wy, wys, wyc, wyy = window
    normal = np.stack(
        [np.stack([w, ws, wc], -1), np.stack([ws, wss, wsc], -1), np.stack([wc, wsc, wcc], -1)], -2
    )
    right = np.stack([wy, wys, wyc], axis=-1)
    ridge = 1e-12 * w[:, None, None] * np.eye(3)
    solution = np.linalg.solve(normal + ridge, right[..., None])[..., 0]
    square = np.maximum(wyy - np.einsum("wi,wi->w", solution, right), 0.0) / w
    amplitude = np.hypot(solution[:, 1], solution[:, 2])
    lag = np.unwrap(np.arctan2(solution[:, 2], solution[:, 1]))
    return LocalSine(
        time=middle + time[0],
        centre=solution[:, 0] + np.mean(x),
        amplitude=amplitude,
        lag=lag,
        residual=np.sqrt(2.0 * square) / np.maximum(amplitude, np.finfo(float).tiny),
        frequency=frequency + _slope(middle, lag) / (2.0 * np.pi),
    )


def _slope(time: Windows, lag: Windows) -> Windows:
    """Slope of the lag over half a period on either side, one-sided at the ends."""
    if time.size < 2:
        return np.zeros_like(lag)
    half = WINDOWS_PER_PERIOD // 2
    k = np.arange(time.size)
    low, high = np.maximum(k - half, 0), np.minimum(k + half, time.size - 1)
    return (lag[high] - lag[low]) / (time[high] - time[low])


def phase_of(fit: LocalSine, time: Samples, start: float, frequency: float) -> Samples:
    """Phase of the fundamental at any time, φ = 2πf (t − start) + lag(t).

    The lag is interpolated between windows; beyond the first and last one it continues with the
    slope over the last half period.

    Args:
        fit: Sinusoids in windows.
        time: [n] s.
        start: s, where the phase of the reference is zero.
        frequency: Hz, of the reference.

    Returns:
        [n] rad.
    """
    lag = np.interp(time, fit.time, fit.lag)
    half = min(WINDOWS_PER_PERIOD // 2, fit.time.size - 1)
    if half > 0:
        early, late = time < fit.time[0], time > fit.time[-1]
        first = (fit.lag[half] - fit.lag[0]) / (fit.time[half] - fit.time[0])
        last = (fit.lag[-1] - fit.lag[-1 - half]) / (fit.time[-1] - fit.time[-1 - half])
        lag = lag + np.where(early, first * (time - fit.time[0]), 0.0)
        lag = lag + np.where(late, last * (time - fit.time[-1]), 0.0)
    return 2.0 * np.pi * frequency * (time - start) + lag
