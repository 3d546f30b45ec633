r"""Profile likelihoods: how far a parameter can go if all others give way.

    p(c) = min over u with θ(u) = c of rᵀΣ⁻¹r,     rise(c) = p(c) − p(θ̂)

A 95 % interval is where the rise stays below 3.84 (χ²₁).  For a linear model that is ±1.96 standard
errors; where parameters run off together the profile turns flat, and its interval is open.
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy.interpolate import PchipInterpolator
from scipy.special import chdtri

from sysid.identification.levenberg_marquardt import gram
from sysid.identification.multistart import BLOCK, in_blocks
from sysid.identification.result import Fit
from sysid.models.coordinates import AbstractCoordinates
from sysid.parameters import ParamSpec, specs
from sysid.uncertainty.covariance import LEVEL
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.free_parameters import free_parameters

SPACING: Final = 0.8
"""Between points, in √rise: the interval is read between them from a curve that is nearly
straight."""
BEYOND: Final = 1.1
"""Times the √rise of the interval's end that a path goes to."""
WIDE_SPACING: Final = 1.1
"""The same where only the ends are asked for."""
MOST_POINTS: Final = 16
FARTHEST: Final = 1.0
"""Longest way between points, in sizes of the parameter: further on nobody knows where to start."""
DAMPING: Final = 1e-2
"""Of a step, per unit of a solver coordinate squared, in rᵀΣ⁻¹r: a coordinate that means nothing
where a path is does not run off."""
PULLED: Final = 0.03
"""√rise for a unit of a coordinate, below which it is brought back before paths start."""
LONGEST: Final = 1.0
"""Longest step of a solver coordinate."""
_MOST_STEPS: Final = 25
_TOLERANCE: Final = 1e-2
"""Of the rise: a hundredth of what one standard error costs."""
_HALVINGS: Final = 7
_ON_TARGET: Final = 1e-4
"""Of the way between two points."""
_NEAR_TARGET: Final = 0.05
_AGAIN: Final = 4


Gram = Callable[[np.ndarray], np.ndarray]
"""u [n] → [J r]ᵀ[J r] under the cost that is profiled, r measured minus model."""


@dataclass(frozen=True)
class Profile:
    """How the likelihood falls along one parameter.

    Attributes:
        declared: The parameter.
        best: Its most probable value.
        values: [p] rising, `best` among them.
        rise: [p] of rᵀΣ⁻¹r, or of another cost over a factor of the parameter's own; at least 0.
        others: [p, n] all free parameters along the path, in the order of `symbols`.
        symbols: Of the free parameters.
        low: Where the interval ends; the parameter's bound, or −∞, where the profile stays below.
        high: Where it ends above.
        closed: The profile rises enough below, and above.
        level: Of the interval.
    """

    declared: ParamSpec
    best: float
    values: Float[np.ndarray, " p"]
    rise: Float[np.ndarray, " p"]
    others: Float[np.ndarray, "p n"]
    symbols: tuple[str, ...]
    low: float
    high: float
    closed: tuple[bool, bool]
    level: float = LEVEL

    @property
    def symbol(self) -> str:
        """Of the parameter."""
        return self.declared.symbol

    @property
    def determined(self) -> bool:
        """The interval has two ends that the data set."""
        return all(self.closed)

    @property
    def root(self) -> Float[np.ndarray, " p"]:
        """[p] signed √rise, a straight line where the model is linear in the parameter."""
        return np.sign(self.values - self.best) * np.sqrt(self.rise)


def profiles(
    fit: Fit,
    errors: ErrorModel,
    symbols: Sequence[str] | None = None,
    *,
    threads: int = 2,
    progress: Callable[[str], None] | None = None,
) -> tuple[Profile, ...]:
    """Profile parameters of a fit.

    Every path starts at the optimum and goes outwards, each point from the one before along the
    direction in which the others give way, so that two or three Gauss–Newton steps are enough.

    Args:
        fit: The fit, for its coordinates.
        errors: Its likelihood; Σ is held.
        symbols: Which; all free ones if None.
        threads: Paths that are followed at once.
        progress: Called with a line now and then.
    """
    coordinates = fit.coordinates

    def under_errors(u: np.ndarray) -> np.ndarray:
        residual, jacobian = errors.observed.look(coordinates, u)
        both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
        if not np.isfinite(both).all():
            return np.full((u.size + 1, u.size + 1), np.nan)
        return errors.power * errors.covariance.inner(both, both)

    wanted = [s for s in coordinates.free if symbols is None or s in symbols]
    u, even = np.asarray(errors.u), dict.fromkeys(wanted, 1.0)
    return _profiles(fit, under_errors, u, even, SPACING, threads, progress)


def profiles_of_eq_11(
    fit: Fit,
    inflation: Mapping[str, float],
    *,
    threads: int = 2,
    progress: Callable[[str], None] | None = None,
) -> tuple[Profile, ...]:
    """Profile the cost that was fitted, each parameter's rise over a factor of its own.

    The sum of squares is no likelihood, but it bends as the parameters do: with the factor that
    makes its curvature that of a covariance which knows the errors, its profile is an interval
    that follows a curved valley.

    Args:
        fit: The fit.
        inflation: Symbol → factor, for the parameters that are wanted: variance of the parameter
            over its element of the inverse of JᵀJ, r relative to the RMS of the measured force.
        threads: Paths that are followed at once.
        progress: Called with a line now and then.

    Source:
        Pace, Salvan and Sartori, Statistica Sinica 21 (2011): adjusted composite likelihood ratio
        for one parameter.
    """
    blocks = tuple(in_blocks(problem, BLOCK) for problem in fit.problems)
    unit = float(np.median(list(inflation.values())))

    def sums(u: np.ndarray) -> np.ndarray:
        # J and r of the model minus the measured force; here r is the other way round
        found = np.array(gram(fit.coordinates, blocks, jnp.asarray(u))) / unit
        found[:-1, -1] *= -1.0
        found[-1, :-1] *= -1.0
        return found

    shares = {s: z / unit for s, z in inflation.items()}
    return _profiles(fit, sums, np.asarray(fit.u), shares, WIDE_SPACING, threads, progress)


def _profiles(
    fit: Fit,
    gram_at: Gram,
    u: Float[np.ndarray, " n"],
    inflation: Mapping[str, float],
    spacing: float,
    threads: int,
    progress: Callable[[str], None] | None,
) -> tuple[Profile, ...]:
    free = fit.coordinates.free
    declared = {s.symbol: s for s in specs(fit.valve)}
    ground = _ground(fit.coordinates, gram_at, u)
    paths: dict[str, list[_Path]] = {}
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(_AGAIN):
            ways = {
                s: [_Way(ground, free.index(s), declared[s], z, factor, spacing) for z in (-1, 1)]
                for s, factor in inflation.items()
            }
            jobs = {s: [pool.submit(_follow, way) for way in both] for s, both in ways.items()}
            paths = {s: [job.result() for job in both] for s, both in jobs.items()}
            lowest = min((p for both in paths.values() for side in both for p in side.points),
                         key=lambda p: p.cost, default=ground.best)  # fmt: skip
            if lowest.cost > ground.best.cost - 2.0 * _TOLERANCE:
                break
            if progress is not None:
                progress("profiles found a better place: they start again from there")
            ground = _ground(fit.coordinates, gram_at, lowest.u)
    return tuple(
        _joined(ground, free, declared[s], both, inflation[s]) for s, both in paths.items()
    )


@dataclass(frozen=True)
class _Point:
    """A place, and the quadratic model of rᵀΣ⁻¹r about it."""

    u: Float[np.ndarray, " n"]
    cost: float
    pull: Float[np.ndarray, " n"]  # β JᵀΣ⁻¹r
    sensitivity: Float[np.ndarray, " n"]  # √rise for a unit of each coordinate
    inverse: Float[np.ndarray, "n n"]  # of β JᵀΣ⁻¹J, damped
    theta: Float[np.ndarray, " k"]
    slopes: Float[np.ndarray, "k n"]  # ∂θ/∂u

    def give_way(self, k: int) -> Float[np.ndarray, " n"]:
        """Change of u per unit of θ_k that costs least."""
        along = self.inverse @ self.slopes[k]
        return along / max(float(self.slopes[k] @ along), 1e-300)


@dataclass(frozen=True)
class _Ground:
    """What all paths share."""

    look: Callable[[np.ndarray], _Point | None]
    best: _Point


def _ground(
    coordinates: AbstractCoordinates[Any], gram_at: Gram, u: Float[np.ndarray, " n"]
) -> _Ground:
    """The optimum near u, none of its coordinates where it means nothing."""
    look = partial(_look, coordinates, gram_at)
    here = look(u)
    if here is None:
        raise ValueError("the model is not finite where its profiles start")
    best = _pulled_in(look, _descended(look, here))
    for _ in range(_AGAIN):
        lower = _descended(look, best)
        if lower.cost > best.cost - 2.0 * _TOLERANCE:
            break
        best = _pulled_in(look, lower)
    return _Ground(look, best)


def _descended(look: Callable[[np.ndarray], "_Point | None"], here: "_Point") -> "_Point":
    for _ in range(_MOST_STEPS):
        lower = _lower(look, here)
        if lower is None or lower.cost > here.cost - _TOLERANCE * 1e-2:
            break
        here = lower
    return here


def _lower(look: Callable[[np.ndarray], "_Point | None"], here: "_Point") -> "_Point | None":
    """A place of less cost along the damped Gauss–Newton step; None if there is none."""
    step = np.clip(here.inverse @ here.pull, -LONGEST, LONGEST)
    for share in (1.0, 0.3, 0.1, 0.03):
        there = look(here.u + share * step)
        if there is not None and there.cost < here.cost:
            return there
    return None


def _pulled_in(look: Callable[[np.ndarray], "_Point | None"], best: "_Point") -> "_Point":
    """The optimum with coordinates that ran off brought back to where they begin to matter.

    Far out nothing depends on them, and a path that starts there could not use them to give way.
    """
    u, enough = best.u, best.cost + _TOLERANCE
    for j in np.flatnonzero(best.sensitivity < PULLED):
        far, near = 1.0, 0.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (far + near)
            there = look(np.where(np.arange(u.size) == j, middle * u, u))
            if there is not None and there.cost < enough:
                far, best = middle, there
            else:
                near = middle
        u, enough = best.u, best.cost + _TOLERANCE
    return best


def _look(
    coordinates: AbstractCoordinates[Any], gram_at: Gram, u: Float[np.ndarray, " n"]
) -> _Point | None:
    gram = gram_at(u)
    theta, slopes = (np.asarray(z) for z in free_parameters(coordinates, jnp.asarray(u)))
    if not (np.isfinite(gram).all() and np.isfinite(slopes).all()):
        return None
    curvature, axes = np.linalg.eigh(gram[:-1, :-1])
    inverse = (axes / (np.maximum(curvature, 0.0) + DAMPING)) @ axes.T
    sensitivity = np.sqrt(np.maximum(np.diagonal(gram)[:-1], 0.0))
    return _Point(u, float(gram[-1, -1]), gram[:-1, -1], sensitivity, inverse, theta, slopes)


@dataclass(frozen=True)
class _Path:
    """One side of a profile: its points outwards, and whether it rose far enough."""

    points: tuple[_Point, ...]
    closed: bool


@dataclass(frozen=True)
class _Way:
    """Where a path starts, along which parameter it goes, and how far its points are apart."""

    ground: _Ground
    k: int
    declared: ParamSpec
    sign: int
    inflation: float
    spacing: float


def _follow(way: _Way) -> _Path:
    """One side of a profile."""
    ground, k, sign = way.ground, way.k, way.sign
    enough = BEYOND * np.sqrt(chdtri(1, 1.0 - LEVEL))
    here, path = ground.best, []
    root, slope = 0.0, 1.0 / (_sd(here, k) * np.sqrt(way.inflation))
    bound = way.declared.low if sign < 0 else way.declared.high
    while root < enough and len(path) < MOST_POINTS:
        size = max(abs(float(here.theta[k])), way.declared.typical)
        far = min(way.spacing / max(slope, 1e-300), FARTHEST * size)
        target = float(here.theta[k]) + sign * far
        room = sign * (bound - float(here.theta[k]))
        if far >= room:  # halfway to the bound: the parameter cannot be there in these coordinates
            if room < 1e-3 * size:
                break
            target = float(here.theta[k]) + sign * 0.5 * room
        there = _constrained(ground, here, k, target)
        if there is None:
            break
        now = float(np.sqrt(max(there.cost - ground.best.cost, 0.0) / way.inflation))
        moved = abs(float(there.theta[k] - here.theta[k]))
        slope = max((now - root) / max(moved, 1e-300), 0.25 * slope)
        path.append(there)
        here, root = there, now
    return _Path(tuple(path), bool(root >= enough / BEYOND))


def _constrained(ground: _Ground, start: _Point, k: int, target: float) -> _Point | None:
    """Least rᵀΣ⁻¹r with θ_k at the target, by Gauss–Newton steps with a linearised constraint."""
    here, last = start, np.inf
    for step in range(_MOST_STEPS):
        way = here.give_way(k)
        free = here.inverse @ here.pull
        missing = target - float(here.theta[k]) - float(here.slopes[k] @ free)
        move = free + way * missing
        gain = float(here.pull @ free) - float(here.slopes[k] @ free) ** 2 / max(
            float(here.slopes[k] @ here.inverse @ here.slopes[k]), 1e-300
        )
        off = abs(target - float(here.theta[k])) / max(abs(target - float(start.theta[k])), 1e-300)
        if step and off < _ON_TARGET and (gain < _TOLERANCE or abs(last - here.cost) < _TOLERANCE):
            return here
        move = np.clip(move, -LONGEST, LONGEST)
        there = None
        for _ in range(4):
            there = ground.look(here.u + move)
            if there is not None and there.cost < 4.0 * here.cost + 100.0:
                break
            move *= 0.3
        if there is None:
            return None
        last, here = here.cost, there
    off = abs(target - float(here.theta[k])) / max(abs(target - float(start.theta[k])), 1e-300)
    return here if off < _NEAR_TARGET else None


def _sd(point: _Point, k: int) -> float:
    return float(np.sqrt(max(point.slopes[k] @ point.inverse @ point.slopes[k], 1e-300)))


def _joined(
    ground: _Ground,
    free: Sequence[str],
    declared: ParamSpec,
    sides: Sequence[_Path],
    inflation: float,
) -> Profile:
    k = list(free).index(declared.symbol)
    below, above = sides
    points = [*below.points[::-1], ground.best, *above.points]
    at = np.array([float(p.theta[k]) for p in points])
    order = np.argsort(at, kind="stable")
    at = at[order]
    points = [points[i] for i in order]
    apart = np.append(True, np.diff(at) > 1e-12 * max(float(np.abs(at).max()), 1e-300))
    at, points = at[apart], [p for p, new in zip(points, apart, strict=True) if new]
    more = np.array([p.cost for p in points]) - ground.best.cost
    rise = np.maximum(more, 0.0) / inflation
    best = float(ground.best.theta[k])
    end = float(np.sqrt(chdtri(1, 1.0 - LEVEL)))
    return Profile(
        declared=declared,
        best=best,
        values=at,
        rise=rise,
        others=np.array([p.theta for p in points]),
        symbols=tuple(free),
        low=_crossing(at, rise, best, -end) if below.closed else declared.low,
        high=_crossing(at, rise, best, end) if above.closed else declared.high,
        closed=(below.closed, above.closed),
    )


def _crossing(
    at: Float[np.ndarray, " p"], rise: Float[np.ndarray, " p"], best: float, end: float
) -> float:
    """Where the signed √rise passes an end of the interval."""
    side = at <= best if end < 0.0 else at >= best
    x, y = at[side], np.sqrt(rise[side])
    if end < 0.0:
        x, y = x[::-1], y[::-1]
    # outwards, as far as it rises: a dip further out does not close the interval again
    y = np.maximum.accumulate(y)
    kept = np.append(True, np.diff(y) > 0.0)
    return float(PchipInterpolator(y[kept], x[kept])(abs(end)))
