"""Straight lines against temperature, weighted, with what the standard errors leave unsaid."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.optimize import root_scalar
from scipy.stats import t as student

FEWEST_TESTS: Final = 3
"""For a line with an interval."""
PAPER_RANGE: Final = (15.0, 75.0)
"""°C, between which the paper tells its changes."""
_PRIOR_REPLICATES: Final = 8.0
"""Each test's variance is drawn towards that of all tests as if so many repetitions told it."""


@dataclass(frozen=True)
class Change:
    """Change between two temperatures in per cent, with its 95 % interval."""

    cold: float
    hot: float
    percent: float
    low: float
    high: float


@dataclass(frozen=True)
class Line:
    """y = intercept + slope·T.

    Attributes:
        intercept: At 0 °C.
        slope: Per kelvin.
        covariance: [2, 2] of both.
        scatter: Standard deviation between tests beyond their standard errors, in units of y.
        temperature: [n] °C.
        value: [n]
        sd: [n] of each value about the line: standard error and scatter.
    """

    intercept: float
    slope: float
    covariance: Float[np.ndarray, "2 2"]
    scatter: float
    temperature: Float[np.ndarray, " test"]
    value: Float[np.ndarray, " test"]
    sd: Float[np.ndarray, " test"]

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.value.size - 2

    @property
    def ends(self) -> tuple[float, float]:
        """°C to compare: the paper's where tests come within 5 K, or coldest and warmest."""
        low, high = float(self.temperature.min()), float(self.temperature.max())
        if low <= PAPER_RANGE[0] + 5.0 and high >= PAPER_RANGE[1] - 5.0:
            return PAPER_RANGE
        return low, high

    @property
    def quantile(self) -> float:
        """Half width of a 95 % interval in standard deviations."""
        return float(student.ppf(0.975, self.freedom))

    @property
    def intervals(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """95 % intervals of intercept and slope."""
        half = self.quantile * np.sqrt(np.diag(self.covariance))
        a, b = self.intercept, self.slope
        return (a - float(half[0]), a + float(half[0])), (b - float(half[1]), b + float(half[1]))

    def at(self, temperature: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The line and its standard deviation, [n] each, at [n] temperatures, °C."""
        rows = np.stack([np.ones_like(temperature), temperature], axis=-1)
        variance = np.einsum("...i,ij,...j", rows, self.covariance, rows)
        return self.intercept + self.slope * temperature, np.sqrt(np.maximum(variance, 0.0))

    def change(self, cold: float, hot: float) -> Change:
        """Change of the line between two temperatures, with Fieller's interval of a ratio.

        A ratio whose denominator may be zero has no interval: it is infinite then.
        """
        (first, last), _ = self.at(np.array([cold, hot]))
        rows = np.array([[1.0, cold], [1.0, hot]])
        v = rows @ self.covariance @ rows.T * self.quantile**2
        a, b, c = first**2 - v[0, 0], first * last - v[0, 1], last**2 - v[1, 1]
        low, high = -np.inf, np.inf
        if a > 0.0:
            half = np.sqrt(max(b * b - a * c, 0.0))
            low, high = (b - half) / a, (b + half) / a
        ratio = last / first if first != 0.0 else np.nan
        percent = [100.0 * (float(z) - 1.0) for z in (ratio, low, high)]
        return Change(cold, hot, *percent)


def fit_line(
    temperature: np.ndarray,
    value: np.ndarray,
    se: np.ndarray,
    replicates: np.ndarray,
    beyond: np.ndarray | None = None,
) -> Line:
    """Least squares with weights 1/(se² + scatter²).

    The scatter between tests is as large as it must be for the residuals to be what is expected of
    n − 2 degrees of freedom (Paule and Mandel 1982); never below zero.

    Args:
        temperature: [n] °C, n ≥ 3, not all equal.
        value: [n]
        se: [n] standard errors; NaN counts as unknown, and is then part of the scatter.
        replicates: [n] repetitions behind each of them.
        beyond: [n] standard deviation that is known beside them; the scatter comes on top.

    Raises:
        ValueError: With fewer tests, or without a difference in temperature.
    """
    if value.size < FEWEST_TESTS or np.ptp(temperature) <= 0.0:
        raise ValueError("a line with an interval needs three tests and two temperatures")
    variance = steadied(se, replicates) + (0.0 if beyond is None else beyond**2)
    scatter = _scatter(temperature, value, variance)
    sd = np.sqrt(variance + scatter**2)
    sd = np.maximum(sd, 1e-12 * np.abs(value).max() + np.finfo(float).tiny)
    centre = float(np.average(temperature, weights=sd**-2))
    rows = np.stack([np.ones_like(temperature), temperature - centre], axis=1) / sd[:, None]
    covariance = np.linalg.inv(rows.T @ rows)
    middle, slope = covariance @ (rows.T @ (value / sd))
    back = np.array([[1.0, -centre], [0.0, 1.0]])
    return Line(
        intercept=float(middle - slope * centre),
        slope=float(slope),
        covariance=back @ covariance @ back.T,
        scatter=scatter,
        temperature=temperature,
        value=value,
        sd=sd,
    )


def steadied(se: np.ndarray, replicates: np.ndarray) -> np.ndarray:
    """Variances for weights: a handful of repetitions says little, all tests together more.

    Args:
        se: [n] standard errors.
        replicates: [n] how many repetitions told each of them.

    Returns:
        [n] variances.
    """
    known = np.isfinite(se) & (replicates > 1)
    if not known.any():
        return np.zeros_like(se)
    freedom = np.where(known, replicates - 1.0, 0.0)
    variance = np.where(known, se, 0.0) ** 2
    pooled = (freedom * variance).sum() / freedom.sum()
    return (_PRIOR_REPLICATES * pooled + freedom * variance) / (_PRIOR_REPLICATES + freedom)


def weighted_residuals(rows: np.ndarray, value: np.ndarray, sd: np.ndarray) -> np.ndarray:
    """Residuals over standard deviations of a weighted least-squares fit.

    Args:
        rows: [n, p] of the design.
        value: [n].
        sd: [n], of each value.

    Returns:
        [n].
    """
    scaled, target = rows / sd[:, None], value / sd
    return target - scaled @ np.linalg.lstsq(scaled, target, rcond=None)[0]


def _scatter(temperature: np.ndarray, value: np.ndarray, variance: np.ndarray) -> float:
    largest = float(np.sqrt(_cost(temperature, value, np.ones_like(value))))
    least = 1e-9 * max(largest, float(np.abs(value).max()))
    if largest <= least:
        return 0.0

    def excess(scatter: float) -> float:
        return _cost(temperature, value, 1.0 / (variance + scatter**2)) - (value.size - 2)

    if excess(least) <= 0.0:
        return 0.0
    found = root_scalar(excess, bracket=(least, 2.0 * largest), xtol=1e-6 * largest)
    return float(found.root)


def _cost(x: np.ndarray, y: np.ndarray, weight: np.ndarray) -> float:
    """Sum of weighted squared residuals about the weighted line."""
    total = weight.sum()
    x, y = x - weight @ x / total, y - weight @ y / total
    slope = (weight * x) @ y / ((weight * x) @ x)
    return float(weight @ (y - slope * x) ** 2)
