"""Are straight lines in temperature enough?  Each law bent in turn, judged on tests left out."""

from dataclasses import dataclass
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.special import stdtrit

from sysid.identification.levenberg_marquardt import descend, residuals
from sysid.identification.multistart import BLOCK, in_blocks
from sysid.identification.problem import Problem, take_points
from sysid.identification.result import Fit
from sysid.models.bent_lumped import BENT_LAWS, BentCoordinates, bent
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.lumped_coordinates import LumpedCoordinates

STEP: Final = 5.0
"""K; tests of one excitation whose temperatures fall into one such step are one block."""
FEWEST_LEVELS: Final = 3
FEWEST_BLOCKS: Final = 6
POINTS: Final = 90
"""Of each loop; laws of temperature show in every point."""
RISK: Final = 0.05
"""Chance, for all laws together, of calling a straight one curved."""
SINGULAR: Final = 1e-10
"""Of the correlation-scaled normal equations: what a block left out alone determined stays."""


@dataclass(frozen=True)
class BentLaw:
    """One law bent, against all straight.

    Attributes:
        symbol: C_post, F_y or k.
        bend: Of the temperature scale; above 0 most change happens where it is cold.
        middle: Part of the change between coldest and warmest that is over half-way in kelvin
            (0.5 for a line).
        error: Mean RMSE/max|F| over blocks, each predicted without it.
        gain: By how much that is below the straight lines' error, mean over blocks.
        low: Lower end of its interval.
        high: Upper end.
    """

    symbol: str
    bend: float
    middle: float
    error: float
    gain: float
    low: float
    high: float

    @property
    def curved(self) -> bool:
        """Better than the line beyond chance."""
        return self.low > 0.0


@dataclass(frozen=True)
class TemperatureLaws:
    """Straight lines against smooth alternatives.

    Attributes:
        error: Mean RMSE/max|F| of straight lines over blocks, each predicted without it; each
            test about its own static force.
        blocks: How many blocks (excitation, temperature).
        level: Of the intervals, such that a straight law is called bent in 5 % of campaigns at
            most.
        laws: One for each law.
    """

    error: float
    blocks: int
    level: float
    laws: tuple[BentLaw, ...]


def compare_laws(fit: Fit) -> TemperatureLaws | str:
    """Bend C_post, F_y and k in turn over temperature, all currents alike, and compare.

    A block is one excitation at one temperature, with all its currents.  Each is predicted by the
    model fitted to all others, which is a Gauss–Newton step away from the fit to all tests.

    Args:
        fit: Of the lumped model.

    Returns:
        The comparison, or a sentence why there is none.
    """
    straight = fit.coordinates
    if not isinstance(straight, LumpedCoordinates) or not fit.condition.size:
        return "Laws of temperature are compared on loops of the lumped model only."
    problem = _thinned(fit.problems[0])
    block, levels = _blocks(fit.condition, np.asarray(problem.motion.temperature)[:, 0])
    if not straight.sloped or levels < FEWEST_LEVELS or block.max() + 1 < FEWEST_BLOCKS:
        return (
            f"Whether laws of temperature bend is not told: that takes tests at {FEWEST_LEVELS} "
            f"temperatures at least, and {FEWEST_BLOCKS} pairs of excitation and temperature."
        )
    peak = np.abs(np.asarray(problem.force)).max(axis=1)
    start = jnp.asarray(np.append(fit.u, 0.0))
    base, _ = _held_out(_coordinates(straight, None), problem, start, block, peak)
    level = 1.0 - 2.0 * RISK / len(BENT_LAWS)
    laws = []
    for symbol in BENT_LAWS:
        error, u = _held_out(_coordinates(straight, symbol), problem, start, block, peak)
        gain = _by_block(base - error, block)
        quantile = float(stdtrit(gain.size - 1, 0.5 + level / 2))
        half = quantile * float(gain.std(ddof=1)) / np.sqrt(gain.size)
        laws.append(
            BentLaw(
                symbol=symbol,
                bend=float(u[-1]),
                middle=float(bent(jnp.asarray([0.5]), jnp.asarray(u[-1]))[0]),
                error=float(_by_block(error, block).mean()),
                gain=float(gain.mean()),
                low=float(gain.mean() - half),
                high=float(gain.mean() + half),
            )
        )
    error = float(_by_block(base, block).mean())
    return TemperatureLaws(error, int(block.max()) + 1, level, tuple(laws))


def _coordinates(straight: LumpedCoordinates, symbol: str | None) -> BentCoordinates:
    return BentCoordinates(straight, jnp.asarray([float(z == symbol) for z in BENT_LAWS]))


def _thinned(problem: Problem) -> Problem:
    """Fewer points of each loop, evenly spread."""
    n = problem.force.shape[1]
    step = max(d for d in range(1, max(1, n // POINTS) + 1) if n % d == 0)
    return take_points(problem, np.arange(0, n, step)) if step > 1 else problem


def _blocks(condition: np.ndarray, temperature: np.ndarray) -> tuple[np.ndarray, int]:
    """Number of each test's block, from 0, and how many temperatures there are."""
    level = np.round(np.where(np.isfinite(temperature), temperature, 0.0) / STEP)
    _, number = np.unique(np.stack([condition, level]), axis=1, return_inverse=True)
    return number.ravel(), np.unique(level).size


def _by_block(values: np.ndarray, block: np.ndarray) -> np.ndarray:
    return np.bincount(block, values) / np.bincount(block)


def _held_out(
    coordinates: BentCoordinates,
    problem: Problem,
    start: Float[Array, " n"],
    block: np.ndarray,
    peak: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """RMSE/max|F| of each test predicted without its block, and the fit to all."""
    end = _descend(coordinates, (in_blocks(problem, BLOCK),), start)
    grams = np.asarray(_test_grams(coordinates, problem, end))
    squares = left_out_squares(grams, block)
    weight = np.asarray(problem.weight)
    rmse = np.sqrt(squares / weight.shape[1]) / weight[:, 0]
    return rmse / peak, np.asarray(end)


def left_out_squares(
    grams: Float[np.ndarray, "test m m"], block: np.ndarray
) -> Float[np.ndarray, " test"]:
    """Squared residuals of each test after a Gauss–Newton step towards the fit without its block.

    Exact for a linear model.

    Args:
        grams: [L, n + 1, n + 1] matrices [J r]ᵀ[J r] of each test at the fit to all.
        block: [L] number of each test's block.
    """
    total, found = grams.sum(axis=0), np.empty(len(grams))
    for number in np.unique(block):
        out = block == number
        rest = total - grams[out].sum(axis=0)
        step = np.append(-_solve(rest[:-1, :-1], rest[:-1, -1]), 1.0)
        found[out] = np.einsum("i,lij,j->l", step, grams[out], step)
    return np.maximum(found, 0.0)


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solution along what the matrix determines."""
    scale = np.sqrt(np.maximum(np.diagonal(matrix), 1e-300))
    value, vector = np.linalg.eigh(matrix / scale[:, None] / scale[None, :])
    seen = value > SINGULAR
    part = vector[:, seen]
    return part @ ((part.T @ (right / scale)) / value[seen]) / scale


@eqx.filter_jit
def _descend(
    coordinates: AbstractCoordinates, parts: tuple[Problem, ...], start: Float[Array, " n"]
) -> Float[Array, " n"]:
    return descend(coordinates, parts, start, tolerance=1e-6, max_steps=30, trust=1e4).u


@eqx.filter_jit
def _test_grams(
    coordinates: AbstractCoordinates, problem: Problem, u: Float[Array, " n"]
) -> Float[Array, "test m m"]:
    """[J r]ᵀ[J r] of each test, J with respect to solver coordinates."""

    def one(test: Problem) -> Array:
        r, push = jax.linearize(lambda z: residuals(coordinates, test, z), u)
        full = jnp.concatenate([jax.vmap(push)(jnp.eye(u.size)), r[None]])
        return full @ full.T

    def by_test(z: Array) -> Array:
        return z if jnp.ndim(z) > 1 else jnp.broadcast_to(z, problem.tests)

    return jax.lax.map(one, jax.tree.map(by_test, problem))
