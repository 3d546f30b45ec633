r"""Paths of profile likelihoods: outwards from the optimum along one parameter.

Each point starts from the one before, along the direction in which the other parameters give way
at least cost, and a few Gauss–Newton steps with a linearised constraint lead to

    min over u with θ_k(u) = c of rᵀΣ⁻¹r
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy.special import chdtri

from sysid.models.coordinates import AbstractCoordinates
from sysid.parameters import ParamSpec
from sysid.uncertainty.covariance import LEVEL
from sysid.uncertainty.free_parameters import free_parameters

BEYOND: Final = 1.1
"""Times the √rise of the interval's end that a path goes to."""
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
SUDDEN: Final = 4.0
"""Times the expected √rise beyond which, and beyond `SMALL`, a rise is sudden."""
SMALL: Final = 0.4
"""√rise that a curved valley may have where none was expected."""
_NEARER: Final = 4
"""Points that are tried, each at half the way of the one before: the last is at an eighth."""
_MOST_STEPS: Final = 25
TOLERANCE: Final = 1e-2
"""Of the rise: a hundredth of what one standard error costs."""
_HALVINGS: Final = 7
_ON_TARGET: Final = 1e-4
"""Of the way between two points."""
_NEAR_TARGET: Final = 0.05
AGAIN: Final = 4

Gram = Callable[[np.ndarray], np.ndarray]
"""u [n] → [J r]ᵀ[J r] under the cost that is profiled, r measured minus model."""


@dataclass(frozen=True)
class Point:
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
class Ground:
    """What all paths share."""

    look: Callable[[np.ndarray], Point | None]
    best: Point


def ground_near(
    coordinates: AbstractCoordinates[Any], gram_at: Gram, u: Float[np.ndarray, " n"]
) -> Ground:
    """The optimum near u, none of its coordinates where it means nothing.

    Raises:
        ValueError: The model is not finite at u.
    """
    look = partial(_look, coordinates, gram_at)
    here = look(u)
    if here is None:
        raise ValueError("the model is not finite where its profiles start")
    best = _pulled_in(look, _descended(look, here))
    for _ in range(AGAIN):
        lower = _descended(look, best)
        if lower.cost > best.cost - 2.0 * TOLERANCE:
            break
        best = _pulled_in(look, lower)
    return Ground(look, best)


def _descended(look: Callable[[np.ndarray], "Point | None"], here: "Point") -> "Point":
    for _ in range(_MOST_STEPS):
        lower = _lower(look, here)
        if lower is None or lower.cost > here.cost - TOLERANCE * 1e-2:
            break
        here = lower
    return here


def _lower(look: Callable[[np.ndarray], "Point | None"], here: "Point") -> "Point | None":
    """A place of less cost along the damped Gauss–Newton step; None if there is none."""
    step = np.clip(here.inverse @ here.pull, -LONGEST, LONGEST)
    for share in (1.0, 0.3, 0.1, 0.03):
        there = look(here.u + share * step)
        if there is not None and there.cost < here.cost:
            return there
    return None


def _pulled_in(look: Callable[[np.ndarray], "Point | None"], best: "Point") -> "Point":
    """The optimum with coordinates that ran off brought back to where they begin to matter.

    Far out nothing depends on them, and a path that starts there could not use them to give way.
    """
    u, enough = best.u, best.cost + TOLERANCE
    for j in np.flatnonzero(best.sensitivity < PULLED):
        far, near = 1.0, 0.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (far + near)
            there = look(np.where(np.arange(u.size) == j, middle * u, u))
            if there is not None and there.cost < enough:
                far, best = middle, there
            else:
                near = middle
        u, enough = best.u, best.cost + TOLERANCE
    return best


def _look(
    coordinates: AbstractCoordinates[Any], gram_at: Gram, u: Float[np.ndarray, " n"]
) -> Point | None:
    gram = gram_at(u)
    theta, slopes = (np.asarray(z) for z in free_parameters(coordinates, jnp.asarray(u)))
    if not (np.isfinite(gram).all() and np.isfinite(slopes).all()):
        return None
    curvature, axes = np.linalg.eigh(gram[:-1, :-1])
    inverse = (axes / (np.maximum(curvature, 0.0) + DAMPING)) @ axes.T
    sensitivity = np.sqrt(np.maximum(np.diagonal(gram)[:-1], 0.0))
    return Point(u, float(gram[-1, -1]), gram[:-1, -1], sensitivity, inverse, theta, slopes)


@dataclass(frozen=True)
class Path:
    """One side of a profile: its points outwards, and whether it rose far enough."""

    points: tuple[Point, ...]
    closed: bool


@dataclass(frozen=True)
class Way:
    """Where a path starts, along which parameter it goes, and how far its points are apart."""

    ground: Ground
    k: int
    declared: ParamSpec
    sign: int
    inflation: float
    spacing: float


def follow(way: Way) -> Path:
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
        there = _reached(way, here, target, root, slope)
        if there is None:
            break
        now = _root(way, there)
        moved = abs(float(there.theta[k] - here.theta[k]))
        slope = max((now - root) / max(moved, 1e-300), 0.25 * slope)
        path.append(there)
        here, root = there, now
    return Path(tuple(path), bool(root >= enough / BEYOND))


def _root(way: Way, point: Point) -> float:
    """√rise."""
    return float(np.sqrt(max(point.cost - way.ground.best.cost, 0.0) / way.inflation))


def _reached(way: Way, here: Point, target: float, root: float, slope: float) -> Point | None:
    """The point at the target, or nearer where the cost rises suddenly on the way there.

    A cost that was flat and then rises at once, however near one comes, is no work of the data: the
    solver's coordinates end there, for what they leave out changes nothing any more (`a_3 I_1`
    beyond 15).  There is no point then.

    Args:
        way: That is followed.
        here: Its last point.
        target: Value of the parameter, in its unit.
        root: √rise at the last point.
        slope: √rise that is expected for a unit of the parameter.
    """
    start = float(here.theta[way.k])
    for _ in range(_NEARER):
        there = _constrained(way.ground, here, way.k, target)
        expected = slope * abs(target - start)
        if there is None or _root(way, there) - root <= SUDDEN * expected + SMALL:
            return there
        target = 0.5 * (start + target)
    return None


def _constrained(ground: Ground, start: Point, k: int, target: float) -> Point | None:
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
        if step and off < _ON_TARGET and (gain < TOLERANCE or abs(last - here.cost) < TOLERANCE):
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


def _sd(point: Point, k: int) -> float:
    return float(np.sqrt(max(point.slopes[k] @ point.inverse @ point.slopes[k], 1e-300)))
