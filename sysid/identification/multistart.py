"""From one rough start to the global minimum: waves of starts until more would change nothing.

Every wave is one vectorised Levenberg–Marquardt over all its starts, on a thinned and bounded part
of the data, so that its cost does not grow with the campaign.  The best basins are then descended
to the bottom on all data.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.errors import FitError
from sysid.identification.levenberg_marquardt import Descent, descend
from sysid.identification.problem import Problem, take_points, take_tests
from sysid.identification.result import Basin, Result
from sysid.models.coordinates import AbstractCoordinates

WAVE: Final = 8
"""Starts a wave: the fewest after which one minimum, always reached, is enough evidence."""
MAX_WAVES: Final = 32
"""Waves at most, if nothing else is asked for."""
SPREADS: Final = (0.7, 1.5, 0.3, 2.5)
"""Standard deviation of the starts about the first one, wave after wave, in solver coordinates
(which are of order one by design)."""
SCREEN_TESTS: Final = 64
SCREEN_POINTS: Final = 24
MIDDLE_TESTS: Final = 256
MIDDLE_POINTS: Final = 72
"""On campaigns much larger than this, most of the way down is gone on a part of that size."""
RAN_OFF: Final = 5.0
"""A coordinate that went further on a part of the data (to where its parameter is as good as zero,
and its derivative too) starts from here on all data, lest it cannot come back."""
BLOCK: Final = 64
"""Tests in a block of the normal equations: a Jacobian that stays in the processor's cache."""
SAME_BASIN: Final = 1e-3
"""Two runs ended in the same basin if their costs agree to this part."""
NOTHING: Final = 1e-10
"""Cost, relative to that of no model at all, below which no measurement could tell two apart."""
FEW_HITS: Final = 3


@dataclass(frozen=True)
class Minimum:
    """The best minimum found.

    Attributes:
        u: [n] solver coordinates.
        cost: Σ w² (F − F̂)² on all data.
        starts: Starts made.
        basins: Minima seen in the waves, best first, costs relative to the best.
        result: How far it can be trusted.
    """

    u: Float[np.ndarray, " n"]
    cost: float
    starts: int
    basins: tuple[Basin, ...]
    result: Result


def find_minimum(
    coordinates: AbstractCoordinates,
    problems: tuple[Problem, ...],
    first: Float[np.ndarray, " n"],
    *,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    max_waves: int = MAX_WAVES,
) -> Minimum:
    """Minimise the cost over all unbounded coordinates.

    Stops when Boender and Rinnooy Kan's estimate of the number of minima does not exceed those
    seen and the best was hit at least three times; gives up after 256 starts and says so.

    Args:
        coordinates: Map from u to the model.
        problems: All tests; one problem for each kind of grid.
        first: [n] start that the features suggest; the waves scatter about it.
        seed: Of the scatter.
        progress: Called with a line after every wave.
        max_waves: Waves at most.

    Raises:
        FitError: The model is not finite at any start.

    Source:
        C. G. E. Boender and A. H. G. Rinnooy Kan, Bayesian stopping rules for multistart global
        optimization methods, Mathematical Programming 37 (1987).
    """
    ends, basins = _waves(coordinates, problems, first, seed, progress, max_waves)
    best = _polish(coordinates, problems, _candidates(np.asarray(ends.u), np.asarray(ends.cost)))
    if not bool(best.converged):
        result = Result.unfinished
    elif basins[0].hits < FEW_HITS:
        result = Result.rare
    else:
        result = Result.converged
    scale = sum(float(np.sum(np.square(p.weight * p.force))) for p in problems)
    return Minimum(np.asarray(best.u), float(best.cost) * scale, ends.cost.size, basins, result)


def _waves(
    coordinates: AbstractCoordinates,
    problems: tuple[Problem, ...],
    first: Float[np.ndarray, " n"],
    seed: int,
    progress: Callable[[str], None] | None,
    max_waves: int,
) -> tuple[Descent, tuple[Basin, ...]]:
    """Ends of all starts on the screening part, stacked, and the basins they fell into."""
    screen = tuple(
        in_blocks(bounded_part(p, SCREEN_TESTS, SCREEN_POINTS), SCREEN_TESTS) for p in problems
    )
    rng = np.random.default_rng(seed)
    waves: list[Descent] = []
    while True:
        scatter = SPREADS[len(waves) % len(SPREADS)] * rng.standard_normal((WAVE, first.size))
        if not waves:
            scatter[0] = 0.0
        wave = _descend_wave(coordinates, screen, jnp.asarray(first + scatter))
        waves.append(jax.device_get(wave))
        ends = jax.tree.map(lambda *z: np.concatenate(z), *waves)
        if not np.isfinite(ends.cost).any():
            raise FitError(
                f"no start of the {type(coordinates).__name__.removesuffix('Coordinates')} model "
                "gives a finite force in all tests",
                advice="Look at the tests' units and currents, or choose another --model",
            )
        basins = _basins(ends.cost, ends.converged)
        if progress is not None:
            seen = f"{len(basins)} minima, the best reached {basins[0].hits} times"
            progress(f"{ends.cost.size} starts, {seen}")
        if len(waves) >= max_waves or _nothing_more_to_find(basins, ends.cost.size):
            return ends, basins


@eqx.filter_jit
def _descend_wave(
    coordinates: AbstractCoordinates, parts: tuple[Problem, ...], starts: Float[Array, "start n"]
) -> Descent:
    return jax.vmap(
        lambda u: descend(coordinates, parts, u, tolerance=1e-4, max_steps=60, trust=1e2)
    )(starts)


@eqx.filter_jit
def _descend_fully(
    coordinates: AbstractCoordinates, parts: tuple[Problem, ...], start: Float[Array, " n"]
) -> Descent:
    return descend(coordinates, parts, start, tolerance=1e-8, max_steps=200, trust=1e8)


def _polish(
    coordinates: AbstractCoordinates, problems: tuple[Problem, ...], starts: list[np.ndarray]
) -> Descent:
    """The lowest end of full descents, each by way of a part of bounded size."""
    for part in (_middle_part(problems), problems):
        if part is None:
            continue
        blocks = tuple(in_blocks(problem, BLOCK) for problem in part)
        ends = [_descend_fully(coordinates, blocks, jnp.asarray(u)) for u in starts]
        starts = [np.clip(end.u, -RAN_OFF, RAN_OFF) for end in ends]
    return min(ends, key=lambda end: float(end.cost))


def _middle_part(problems: tuple[Problem, ...]) -> tuple[Problem, ...] | None:
    """A part of bounded size; None where all data are hardly larger."""
    part = tuple(bounded_part(p, MIDDLE_TESTS, MIDDLE_POINTS) for p in problems)
    points = [sum(np.size(p.force) for p in some) for some in (part, problems)]
    return part if points[1] > 8 * points[0] else None


def bounded_part(problem: Problem, tests: int, points: int) -> Problem:
    """A part of a problem whose size does not grow with the campaign.

    Args:
        problem: All tests.
        tests: At most so many are kept, evenly spread over (current, v_m).
        points: Of each, at least so many, and more where tests are few.
    """
    n = problem.force.shape[1]
    wanted = max(points, tests * points // problem.tests)
    # a divisor of n keeps the grid of a loop periodic and even
    step = max(d for d in range(1, max(1, n // wanted) + 1) if n % d == 0)
    part = take_points(problem, np.arange(0, n, step)) if step > 1 else problem
    if problem.tests <= tests:
        return part
    current, speed = np.asarray(problem.motion.current), np.asarray(problem.motion.peak_velocity)
    order = np.lexsort((speed.max(axis=1), current.max(axis=1)))
    return take_tests(part, order[np.linspace(0, order.size - 1, tests).astype(int)])


def in_blocks(problem: Problem, size: int) -> Problem:
    """Arrays [B, size', n] with size' ≤ size; the last block is filled up with weightless tests.

    size' is a multiple of 8 where `size` is, so that campaigns of nearly the same number of tests
    share compiled programs.
    """
    count = -(-problem.tests // size)
    size = min(size, -(-problem.tests // (8 * count)) * 8)
    missing = count * size - problem.tests
    index = np.concatenate([np.arange(problem.tests), np.zeros(missing, dtype=int)])
    filled = take_tests(problem, index)
    weight = np.asarray(filled.weight).copy()
    weight[problem.tests :] = 0.0

    def fold(z: Array | np.ndarray) -> np.ndarray:
        z = np.asarray(z)
        return z.reshape(count, size, *z.shape[1:]) if z.ndim > 1 else np.broadcast_to(z, count)

    filled = Problem(filled.motion, filled.force, weight, filled.reference)
    return jax.tree.map(fold, filled)


def _basins(costs: np.ndarray, converged: np.ndarray) -> tuple[Basin, ...]:
    """Group the ends of converged runs (of all runs if none converged) by cost."""
    finite = np.isfinite(costs)
    kept = np.sort(costs[finite & converged] if (finite & converged).any() else costs[finite])
    basins: list[tuple[float, int]] = []
    for cost in kept:
        if basins and cost <= basins[-1][0] * (1.0 + SAME_BASIN) + NOTHING:
            basins[-1] = (basins[-1][0], basins[-1][1] + 1)
        else:
            basins.append((float(cost), 1))
    best = max(basins[0][0], NOTHING)
    return tuple(Basin(max(cost, NOTHING) / best, hits) for cost, hits in basins)


def _nothing_more_to_find(basins: tuple[Basin, ...], starts: int) -> bool:
    w = len(basins)
    if basins[0].hits < FEW_HITS or starts <= w + 2:
        return False
    return w * (starts - 1) / (starts - w - 2) < w + 0.5


def _candidates(u: np.ndarray, costs: np.ndarray, count: int = 3) -> list[np.ndarray]:
    """The best end and the next basins whose cost is close enough to change order on all data."""
    order = np.argsort(np.where(np.isfinite(costs), costs, np.inf))
    chosen = [order[0]]
    for k in order[1:]:
        if len(chosen) == count or costs[k] > 1.05 * costs[order[0]]:
            break
        if costs[k] > costs[chosen[-1]] * (1.0 + SAME_BASIN):
            chosen.append(k)
    return [u[k] for k in chosen]
