"""From samples at any phase to bin means of each cycle on the phase grid.

A grid value is the mean of the signal over one phase bin: an interpolant's antiderivative is
differenced at the bin edges.  With many samples a bin that is their average, with few it is
interpolation.

With fewer samples a cycle than bins, interpolating each cycle alone cuts corners at the knees of
a damper's loop, while the cycles together may have samples enough (equivalent-time sampling).
Then a template is fitted to the samples of all cycles, each brought to common gain and offset: a
periodic cubic spline with a roughness penalty.  Only what each cycle departs from the template is
interpolated cycle by cycle, so that averaging over cycles is the same as without it.  How rough
the template may be, or whether there is none, is decided for each test by predicting cycles that
were held out: on a repeatable loop it gains much, where a jump moves from cycle to cycle it would
only follow the scatter.

Measured RMS error (N) of the mean of 9 cycles of a loop 1000·tanh(16(v/v_m ∓ 0.12)) + 150·v/v_m + …
(here | monotone cubic each cycle | linear each cycle), by samples a cycle, without noise:
20.4: 5.1 | 92 | 116; 39.2: 3.1 | 31 | 52; 72.1: 0.25 | 7.0 | 19; 500: 0.006 | 0.006 | 0.036;
4000: all below 0.5.  With noise of 5 N and gains that wander by 1.5 % from cycle to cycle:
20.4: 8.3 | 93 | 116; 39.2: 4.6 | 31 | 52; 72.1: 2.4 | 7.0 | 19; 500: 1.3 | 1.3 | 2.8.
Where the samples of all cycles fall on the same phases nothing can be gained (39.0: 52 | 46 | 63).
"""

import numpy as np
from jaxtyping import Float, Int

Samples = Float[np.ndarray, " n"]
Grid = Float[np.ndarray, "cycle phase"]

ROUGHNESS = (1e-3, 1e-2, 1e-1, 1.0, 10.0)
"""Weights to choose from of the spline's squared second differences, beside the sample density."""
MARGIN = 0.25
FOLDS = 3


def phase_average(phase: Samples, values: Samples, first: int, cycles: int, points: int) -> Grid:
    """Bin means of whole cycles.

    Args:
        phase: [n] rad, strictly increasing.
        values: [n] signal, any unit.
        first: Index of the first grid point, whose phase is 2π·first/points.
        cycles: Number of whole cycles from there; samples beyond either end are taken from the
            other end, `cycles` cycles apart, for at most the width of a sample and a bin.
        points: J.

    Returns:
        [cycles, points], column j at phase 2πj/J whatever `first` is.
    """
    density = 2.0 * np.pi * (phase.size - 1) / (phase[-1] - phase[0])
    if density >= points or cycles < FOLDS:
        return _bin_means(phase, values, first, cycles, points)
    cycle = np.floor((phase - phase[0]) / (2.0 * np.pi) + 1e-6).astype(np.int64)
    inside = cycle < cycles
    aligned = _align(phase[inside], values[inside], cycle[inside], points)
    roughness = _choose_roughness(phase[inside], aligned, cycle[inside], points)
    if roughness is None:
        return _bin_means(phase, values, first, cycles, points)
    template = Template(phase[inside], aligned, points).spline(roughness)
    rest = values - spline_value(template, phase)
    return spline_bin_mean(template) + _bin_means(phase, rest, first, cycles, points)


def _bin_means(phase: Samples, values: Samples, first: int, cycles: int, points: int) -> Grid:
    """Difference the antiderivative of a monotone cubic interpolant at the bin edges."""
    from scipy.interpolate import PchipInterpolator

    width = 2.0 * np.pi / points
    edges = width * (first - 0.5 + np.arange(cycles * points + 1))
    around, signal = _wrap(phase, values, 2.0 * np.pi * cycles, edges[0], edges[-1])
    whole = PchipInterpolator(around, signal).antiderivative()(edges)
    return np.roll(np.diff(whole).reshape(cycles, points) / width, first, axis=1)


def _wrap(
    phase: Samples, values: Samples, span: float, low: float, high: float
) -> tuple[Float[np.ndarray, " wrapped"], Float[np.ndarray, " wrapped"]]:
    """Continue a signal periodically, by one sample beyond `low` and `high`."""
    before, after = phase - span, phase + span
    apart = 0.25 * (phase[-1] - phase[0]) / (phase.size - 1)
    head = np.flatnonzero(before < phase[0] - apart)
    head = head[np.searchsorted(before[head], low, side="right") - 1 :] if head.size else head
    tail = np.flatnonzero(after > phase[-1] + apart)
    tail = tail[: np.searchsorted(after[tail], high) + 1]
    return (
        np.concatenate([before[head], phase, after[tail]]),
        np.concatenate([values[head], values, values[tail]]),
    )


def _align(phase: Samples, values: Samples, cycle: Int[np.ndarray, " n"], points: int) -> Samples:
    """Remove each cycle's gain and offset relative to the others."""
    aligned = values
    for _ in range(2):
        spline = Template(phase, aligned, points).spline(ROUGHNESS[-1])
        gain, offset = _gain_and_offset(spline_value(spline, phase), values, cycle)
        gain, offset = gain / np.mean(gain), offset - np.mean(offset)
        aligned = (values - offset[cycle]) / gain[cycle]
    return aligned


def _choose_roughness(
    phase: Samples, values: Samples, cycle: Int[np.ndarray, " n"], points: int
) -> float | None:
    """The roughness that predicts held-out cycles best; None if no template does."""
    choices = (*ROUGHNESS, None)
    error = np.zeros(len(choices))
    grid = 2.0 * np.pi * np.arange(points + 1) / points
    for fold in range(FOLDS):
        out = cycle % FOLDS == fold
        kept, index = np.unique(cycle[~out], return_inverse=True)
        joined = phase[~out] - 2.0 * np.pi * (kept[index] - index)
        train, first = values[~out], int(np.ceil(joined[0] * points / (2.0 * np.pi)))
        template = Template(joined, train, points)
        for k, roughness in enumerate(choices):
            spline = np.zeros(points) if roughness is None else template.spline(roughness)
            rest = train - spline_value(spline, joined)
            mean = _bin_means(joined, rest, first, kept.size, points).mean(axis=0)
            mean = mean + spline_bin_mean(spline)
            guess = np.interp(phase[out] % (2.0 * np.pi), grid, np.append(mean, mean[0]))
            error[k] += np.sum((values[out] - guess) ** 2)
    return choices[int(np.argmin(error))]


def _gain_and_offset(
    model: Samples, values: Samples, cycle: Int[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, " cycle"], Float[np.ndarray, " cycle"]]:
    """Straight line of values over model for each cycle, gains kept within ±20 %."""
    n = np.bincount(cycle)
    mean_m = np.bincount(cycle, model) / n
    mean_v = np.bincount(cycle, values) / n
    dm = model - mean_m[cycle]
    square = np.maximum(np.bincount(cycle, dm * dm), np.finfo(float).tiny)
    gain = np.clip(np.bincount(cycle, dm * values) / square, 0.8, 1.2)
    return gain, mean_v - gain * mean_m


def _basis(phase: Samples, knots: int) -> tuple[Int[np.ndarray, "4 n"], Float[np.ndarray, "4 n"]]:
    """Indices and weights of the four uniform cubic B-splines at each phase."""
    u = phase * (knots / (2.0 * np.pi))
    k = np.floor(u).astype(np.int64)
    t = u - k
    weight = np.stack(
        [(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]
    )
    return (k + np.arange(-1, 3)[:, None]) % knots, weight / 6.0


class Template:
    """Normal equations of a periodic uniform cubic spline, solved for any roughness.

    The period is continued by `MARGIN` of itself at both ends, so that the equations are banded;
    influence decays within a few gaps between samples.
    """

    def __init__(self, phase: Samples, values: Samples, knots: int) -> None:
        index, weight = _basis(phase, knots)
        right = np.bincount(index.ravel(), (weight * values).ravel(), knots)
        self._knots, self._margin = knots, int(MARGIN * knots)
        around = np.arange(-self._margin, knots + self._margin)
        self._right = right[around % knots]
        self._normal = np.zeros((4, around.size))
        for apart in range(4):
            product = (weight[: 4 - apart] * weight[apart:]).ravel()
            band = np.bincount(index[: 4 - apart].ravel(), product, knots)
            self._normal[apart] = band[around % knots]
        density = phase.size / knots
        self._penalty = density * np.array([6.0, -4.0, 1.0, 0.0])[:, None]

    def spline(self, roughness: float) -> Samples:
        """Coefficients of the spline."""
        from scipy.linalg import solveh_banded

        band = self._normal + roughness * self._penalty
        return solveh_banded(band, self._right, lower=True)[self._margin :][: self._knots]


def spline_value(coefficients: Float[np.ndarray, " knot"], phase: Samples) -> Samples:
    """Value of the periodic spline at any phase, rad."""
    index, weight = _basis(phase, coefficients.size)
    return np.sum(weight * coefficients[index], axis=0)


def spline_bin_mean(coefficients: Samples) -> Samples:
    """Exact mean over each bin centred on a knot: (1, 76, 230, 76, 1)/384 of the coefficients."""
    near = np.roll(coefficients, 1) + np.roll(coefficients, -1)
    far = np.roll(coefficients, 2) + np.roll(coefficients, -2)
    return (230.0 * coefficients + 76.0 * near + far) / 384.0
