"""Is a straight line against temperature enough, or do the data bend?"""

from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import f as fisher

from sysid.identification.straight_lines.lines import Line

ZERO_CELSIUS: Final = 273.15
SHOWN: Final = 0.05
"""Chance of bending by chance, below which a curvature counts as shown."""
_FREE_FALL: Final = 2000.0
"""K below the data where a Vogel temperature makes no difference to an exponential."""


@dataclass(frozen=True)
class Rival:
    """A curve in the line's place.

    Attributes:
        name: line, Arrhenius or Vogel.
        numbers: How many it has.
        cost: Sum of squared residuals over variances.
        aicc: Corrected Akaike criterion, lower is better; NaN where tests are too few for it.
        temperature: Of its law, K (Arrhenius: activation temperature B of A exp(B/T); Vogel: T_0
            in °C of A exp(B/(T − T_0))); NaN for the line.
    """

    name: str
    numbers: int
    cost: float
    aicc: float
    temperature: float


@dataclass(frozen=True)
class Curvature:
    """Lack of fit of a line.

    Attributes:
        p: Chance that a straight truth bends as much (F test of a quadratic term); NaN with
            fewer than four tests.
        f: The F ratio, with 1 and `freedom` degrees of freedom.
        freedom: Of the denominator.
        rivals: Line, Arrhenius, Vogel, in this order, as far as they apply.
        bend: Largest difference between parabola and line in the range, in parts of the line's
            mean.
    """

    p: float
    f: float
    freedom: int
    rivals: tuple[Rival, ...]
    bend: float

    @property
    def shown(self) -> bool:
        """Whether the data bend."""
        return self.p < SHOWN

    @property
    def best(self) -> Rival:
        """The rival with the lowest AICc; the line where none can be compared."""
        known = [r for r in self.rivals if np.isfinite(r.aicc)]
        return min(known, key=lambda r: r.aicc) if known else self.rivals[0]


class _Bent(NamedTuple):
    """A line and a parabola through the same tests: costs, freedom of the parabola, bend."""

    straight: float
    bent: float
    freedom: int
    bend: float


def curvature_of(line: Line) -> Curvature:
    """Test a line against a quadratic term, and hold Arrhenius and Vogel beside it.

    The F test needs no scale: only the tests' relative variances enter.
    """
    t, y, sd = line.temperature, line.value, line.sd
    bent = _parabola(line)
    ratio, p = np.nan, np.nan
    if bent.freedom > 0:
        gained = bent.straight - bent.bent
        ratio = gained / (bent.bent / bent.freedom) if bent.bent > 0.0 else np.inf
        p = float(fisher.sf(ratio, 1, bent.freedom))
    cost = bent.straight
    rivals = [Rival("line", 2, cost, _aicc(cost, y.size, 2), np.nan)]
    if (y > 0.0).all():
        kelvin = t + ZERO_CELSIUS
        cost, shape = _exponential(1.0 / kelvin, y, sd)
        rivals.append(Rival("Arrhenius", 2, cost, _aicc(cost, y.size, 2), shape))
        cost, shape = _vogel(t, y, sd)
        rivals.append(Rival("Vogel", 3, cost, _aicc(cost, y.size, 3), shape))
    return Curvature(p, float(ratio), bent.freedom, tuple(rivals), bent.bend)


def pooled_p(lines: list[Line]) -> float:
    """Chance that straight truths bend as much as all lines of one law together."""
    known = [z for z in map(_parabola, lines) if z.freedom > 0]
    left, freedom = sum(z.bent for z in known), sum(z.freedom for z in known)
    gained, terms = sum(z.straight for z in known) - left, len(known)
    if terms == 0:
        return float("nan")
    if left <= 0.0:
        return 0.0 if gained > 0.0 else 1.0
    return float(fisher.sf((gained / terms) / (left / freedom), terms, freedom))


def _parabola(line: Line) -> _Bent:
    u = (line.temperature - line.temperature.mean()) / np.ptp(line.temperature)
    rows = np.stack([np.ones_like(u), u, u**2], axis=1)
    target, scaled = line.value / line.sd, rows / line.sd[:, None]
    found = [np.linalg.lstsq(scaled[:, :n], target, rcond=None)[0] for n in (2, 3)]
    costs = [float(((target - scaled[:, : p.size] @ p) ** 2).sum()) for p in found]
    straight, bent = (rows[:, : p.size] @ p for p in found)
    bend = float(np.abs(bent - straight).max() / np.abs(straight).mean())
    return _Bent(costs[0], costs[1], line.value.size - 3, bend)


def _aicc(cost: float, n: int, numbers: int) -> float:
    """N ln(cost/n) + 2K + 2K(K+1)/(n−K−1), with K counting the unknown scale too."""
    k = numbers + 1
    if n - k - 1 <= 0:
        return float("nan")
    return n * float(np.log(max(cost, 1e-300) / n)) + 2 * k + 2 * k * (k + 1) / (n - k - 1)


def _exponential(z: np.ndarray, y: np.ndarray, sd: np.ndarray) -> tuple[float, float]:
    """Cost and exponent B of y = A exp(B z), by Gauss-Newton from the line through ln y."""
    centred = (z - z.mean()) / np.ptp(z)
    rows = np.stack([np.ones_like(z), centred], axis=1)
    p = np.linalg.lstsq(rows * (y / sd)[:, None], np.log(y) * y / sd, rcond=None)[0]
    before = cost = np.inf
    for _ in range(30):
        shown = np.exp(rows @ p)
        before, cost = cost, float((((y - shown) / sd) ** 2).sum())
        if not before - cost > 1e-10 * cost:
            break
        p = p + np.linalg.lstsq(rows * (shown / sd)[:, None], (y - shown) / sd, rcond=None)[0]
    return min(cost, before), float(p[1] / np.ptp(z))


def _vogel(t: np.ndarray, y: np.ndarray, sd: np.ndarray) -> tuple[float, float]:
    """Cost and T_0 of y = A exp(B/(T − T_0)), T_0 below the data."""

    def cost(log_below: float) -> float:
        return _exponential(1.0 / (t - t.min() + np.exp(log_below)), y, sd)[0]

    trials = np.linspace(np.log(2.0), np.log(_FREE_FALL), 15)
    start = int(np.argmin([cost(z) for z in trials]))
    low, high = trials[max(start - 1, 0)], trials[min(start + 1, trials.size - 1)]
    # SciPy tells no type of its results
    found: Any = minimize_scalar(cost, bounds=(float(low), float(high)), method="bounded")
    return float(found.fun), float(t.min() - np.exp(found.x))
