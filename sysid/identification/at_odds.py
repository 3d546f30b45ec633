"""Tests that all others contradict: the model fitted to the rest misses them by far."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from sysid.data.figures import figure
from sysid.data.loops import Loops
from sysid.identification.families import family
from sysid.identification.features import loop_features
from sysid.identification.levenberg_marquardt import gram_of_each
from sysid.identification.looks_like import looks_like
from sysid.identification.multistart import find_minimum, in_blocks
from sysid.identification.problem import Problem, test_weights, weighted
from sysid.identification.result import Fit
from sysid.models.base import AbstractValve
from sysid.models.coordinates import AbstractCoordinates, valve_at
from sysid.models.simulate import simulate

FEWEST: Final = 8
"""Loops below which none can be told from the rest."""
PART: Final = 8
"""One test in so many may be at odds with the others."""
MOST: Final = 4
"""Tests at odds at most: more are a pattern, not slips."""
SUSPECT: Final = 0.5
"""Part of the cost that may be left without them, to first order; where more is, nobody is
suspected."""
TIMES: Final = 4.0
"""How many times the largest error of the others a test at odds is missed by, at least."""
LEAST: Final = 0.05
"""RMSE/max|F| below which nobody needs to be told."""
BEYOND: Final = 1.1
"""Factor by which amplitude, frequency or speed may lie beyond those of the others: further out it
may be the model that fails."""
BEYOND_CURRENT: Final = 0.05
"""The same of the current, as a part of the largest."""
FALLS: Final = 0.8
"""Factor from which it is worth telling by how much the error of the others falls."""
WAVES: Final = 4
"""Waves of starts of a fit to the others at most."""
RIDGE: Final = 1e-9
"""Of the scaled normal equations, which tests that are left may not determine."""


@dataclass(frozen=True)
class OddTest:
    """A test that the others contradict.

    Attributes:
        id: Of the test.
        missed: RMSE/max|F| of the model fitted to the others.
        looks: What one number would explain nine tenths of that, each a clause for people; empty
            where none does.
    """

    id: str
    missed: float
    looks: tuple[str, ...]


@dataclass(frozen=True)
class AtOdds:
    """Tests that the others contradict.

    Attributes:
        tests: The worst first.
        others: How many the others are.
        largest: The largest RMSE/max|F| of the others under the model fitted to them.
        before: Mean RMSE/max|F| of the others with all tests fitted.
        after: The same with them alone fitted.
    """

    tests: tuple[OddTest, ...]
    others: int
    largest: float
    before: float
    after: float

    @property
    def ids(self) -> tuple[str, ...]:
        """Their ids."""
        return tuple(test.id for test in self.tests)

    @property
    def words(self) -> tuple[str, ...]:
        """What to say of each test."""
        return tuple(f"{id} {why}" for id, why in zip(self.ids, self.reasons, strict=True))

    @property
    def reasons(self) -> tuple[str, ...]:
        """The same without its id."""
        falls = (
            f", whose mean error falls from {_percent(self.before)} to {_percent(self.after)} "
            f"without {'it' if len(self.tests) == 1 else f'the {len(self.tests)} that are at odds'}"
            if self.after < FALLS * self.before
            else ""
        )
        return tuple(
            f"does not agree with the other {self.others} tests{falls}: the "
            f"model fitted to them misses it by {_percent(test.missed)} of its peak force (RMS), "
            f"and each of them by {_percent(self.largest)} at most."
            + (f" It looks as if {' or '.join(test.looks)}." if test.looks else "")
            for test in self.tests
        )


def at_odds(fit: Fit, loops: Loops) -> AtOdds | None:
    """The few tests of a fit that all others contradict, by slips of whoever recorded them.

    Without them (at most `MOST`, and one in `PART`) the model errs little on every other test, and
    misses each of them by `TIMES` the largest of these errors; and their amplitude, frequency,
    speed and current lie among those of the others.  Which tests they could be is found to first
    order: the cost without a test, at the best parameters without it, follows from the normal
    equations of each.  Where such few tests do not hold half of it, nothing is fitted.

    Args:
        fit: Of these loops.
        loops: [L] loops that were fitted, in their order.

    Returns:
        None where no test stands out so.
    """
    count = len(loops.ids)
    most = min(MOST, count // PART)
    if count < FEWEST or not fit.cost > 0.0:
        return None
    free, noise = fit.coordinates.statics_free, _noise(loops)
    for out in _suspects(fit.coordinates, _alike(fit.problems[0], loops), fit.u, noise, most):
        kept = np.ones(count, dtype=bool)
        kept[out] = False
        if not _among(loops, kept):
            continue
        valve = _fitted_to(fit, loops, kept)
        error = _errors(fit, valve, noise)
        largest = float(error[kept].max())
        if error[out].min() < max(TIMES * largest, LEAST):
            continue
        order = [int(k) for k in np.argsort(-error) if not kept[k]]
        return AtOdds(
            tests=tuple(
                OddTest(
                    loops.ids[k],
                    float(error[k]),
                    looks_like(valve, loops, k, kept, spread=largest, statics_free=free),
                )
                for k in order
            ),
            others=int(kept.sum()),
            largest=largest,
            before=float(_errors(fit, fit.valve, noise)[kept].mean()),
            after=float(error[kept].mean()),
        )
    return None


def _alike(problem: Problem, loops: Loops) -> Problem:
    """Every test relative to its peak force, however the fit weighted them."""
    weight = np.broadcast_to(test_weights(loops, "peak")[:, None], loops.force.shape)
    return Problem(problem.motion, problem.force, jnp.asarray(weight), problem.reference)


def _noise(loops: Loops) -> Float[np.ndarray, " loop"]:
    """RMS noise of each cycle mean over max|F|; zero where a single cycle does not show it."""
    mean = loops.mean_cycle_noise / np.abs(loops.force).max(axis=1)
    return np.where(np.isfinite(mean), mean, 0.0)


def _suspects(
    coordinates: AbstractCoordinates,
    problem: Problem,
    u: Float[np.ndarray, " n"],
    noise: Float[np.ndarray, " loop"],
    most: int,
) -> Iterator[np.ndarray]:
    """The worst test, the two worst, …; nothing where `most` of them do not hold enough."""
    grams = np.array(gram_of_each(coordinates, in_blocks(problem, 1), jnp.asarray(u)))
    grams[:, -1, -1] -= problem.force.shape[1] * noise**2
    left = grams.sum(axis=0)
    whole = _least(left)
    out: list[int] = []
    cost = whole
    for _ in range(most):
        costs = [np.inf if k in out else _least(left - g) for k, g in enumerate(grams)]
        out.append(int(np.argmin(costs)))
        cost, left = costs[out[-1]], left - grams[out[-1]]
    if np.isfinite(cost) and cost <= SUSPECT * whole:
        yield from (np.array(out[: k + 1]) for k in range(most))


def _least(gram: Float[np.ndarray, "m m"]) -> float:
    """Σ r² at the minimum of the linearised problem."""
    scale = np.sqrt(np.maximum(np.diag(gram)[:-1], 0.0))
    scale = np.where(scale > 0.0, scale, 1.0)
    normal = gram[:-1, :-1] / scale / scale[:, None] + RIDGE * np.eye(scale.size)
    slope = gram[:-1, -1] / scale
    try:
        step = np.linalg.solve(normal, slope)
    except np.linalg.LinAlgError:
        return float("inf")
    return float(gram[-1, -1] - slope @ step)


def _fitted_to(fit: Fit, loops: Loops, kept: Bool[np.ndarray, " loop"]) -> AbstractValve:
    """The model fitted to a part of the loops, and to all other records of the fit."""
    problem = fit.problems[0]
    weight = jnp.where(kept[:, None], jnp.asarray(problem.weight), 0.0)
    part = Problem(problem.motion, problem.force, weight, problem.reference)
    first = family(fit.model, fit.variant).start(loop_features(loops.select(kept)), fit.coordinates)
    best = find_minimum(fit.coordinates, (part, *fit.problems[1:]), first, max_waves=WAVES)
    return valve_at(fit.coordinates, jnp.asarray(best.u))


def _errors(
    fit: Fit, valve: AbstractValve, noise: Float[np.ndarray, " loop"]
) -> Float[np.ndarray, " loop"]:
    """RMSE/max|F| of each loop beyond its noise, about its static force where that is free."""
    problem, statics_free = fit.problems[0], fit.coordinates.statics_free
    force = np.asarray(problem.force)
    excess = simulate(valve, problem.motion) - problem.force
    left = np.asarray(weighted(excess, np.ones_like(force), statics_free=statics_free))
    square = np.mean(left**2, axis=1) / np.abs(force).max(axis=1) ** 2
    return np.sqrt(np.maximum(square - noise**2, 0.0))


def _among(loops: Loops, kept: Bool[np.ndarray, " loop"]) -> bool:
    """Whether those that are not kept lie within the settings of those that are."""
    speed, current = loops.amplitude * loops.frequency, np.abs(loops.current)
    far = np.log(BEYOND)
    return all(
        z[~kept].max() <= z[kept].max() + more and z[~kept].min() >= z[kept].min() - more
        for z, more in (
            (np.log(loops.amplitude), far),
            (np.log(loops.frequency), far),
            (np.log(speed), far),
            (current, BEYOND_CURRENT * float(current.max())),
        )
    )


def _percent(part: float) -> str:
    return f"{figure(100.0 * part, 2)} %"
