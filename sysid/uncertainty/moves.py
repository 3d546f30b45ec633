r"""How walkers of an ensemble move.

Two kinds, mixed at random:

- a jump to a draw of a Student t density that was fitted to the warm-up, wherever the walker is
  (an independence move): in value-type coordinates posteriors are nearly normal, and a third of
  such jumps is accepted;
- differential evolution: a step along the difference of two other walkers, which needs no density
  and reaches what the first misses (skewed ends at bounds, directions that only the prior holds).

emcee's snooker move is not among them: in 3.1.6 its step grows with the distance from the walker it
aims at while its weight does not account for that, and a unit normal in five dimensions comes out
with a variance of 0.70 (`tests/uncertainty/test_moves.py`).

Source:
    Tierney, Annals of Statistics 22 (1994): independence chains.  Ter Braak, Statistics and
    Computing 16 (2006), Nelson, Ford and Payne, ApJS 210:11 (2014): differential evolution.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from emcee.moves import DEMove, MHMove
from jaxtyping import Float

FREEDOM: Final = 8.0
"""Degrees of freedom of the t density: tails heavier than a posterior's, or walkers out there would
stay for long."""
WIDER: Final = 1.0
JUMPS: Final = 0.6
"""Share of independence moves."""
SWAPS: Final = 0.05
"""Share of steps by the whole difference, which lead from one mode to another."""


@dataclass(frozen=True)
class Jump:
    """A Student t density in n dimensions.

    Attributes:
        mean: [n].
        root: [n, n] lower triangle L, LLᵀ its scale matrix.
    """

    mean: Float[np.ndarray, " n"]
    root: Float[np.ndarray, "n n"]

    def draw(
        self, count: int, random: np.random.RandomState | np.random.Generator
    ) -> Float[np.ndarray, "count n"]:
        """Draws."""
        z = random.standard_normal((count, self.mean.size))
        spread = np.sqrt(FREEDOM / random.chisquare(FREEDOM, (count, 1)))
        return self.mean + (z * spread) @ self.root.T

    def log_density(self, u: Float[np.ndarray, "count n"]) -> Float[np.ndarray, " count"]:
        """Up to a constant."""
        z = np.linalg.solve(self.root, (u - self.mean).T)
        return -0.5 * (FREEDOM + self.mean.size) * np.log1p(np.sum(z**2, axis=0) / FREEDOM)

    def propose(
        self, u: Float[np.ndarray, "count n"], random: np.random.RandomState
    ) -> tuple[Float[np.ndarray, "count n"], Float[np.ndarray, " count"]]:
        """Places to go to, and ln q(u)/q(u') of each."""
        there = self.draw(len(u), random)
        return there, self.log_density(u) - self.log_density(there)


def jump_of(mean: Float[np.ndarray, " n"], covariance: Float[np.ndarray, "n n"]) -> Jump:
    """The t density of a mean and a scale matrix, which may be nearly singular."""
    scale = np.sqrt(np.maximum(np.diagonal(covariance), 1e-300))
    correlation = covariance / scale[:, None] / scale[None, :]
    root = np.linalg.cholesky(correlation + 1e-10 * np.eye(mean.size))
    return Jump(np.array(mean), WIDER * scale[:, None] * root)


def jump_fitted(draws: Float[np.ndarray, "draw n"]) -> Jump:
    """The t density that fits draws: their mean and covariance."""
    return jump_of(draws.mean(axis=0), np.cov(draws, rowvar=False).reshape((draws.shape[1],) * 2))


def moves(jump: Jump | None) -> Sequence[tuple[Any, float]]:
    """Moves and their shares, as emcee takes them; without jumps if there is no density yet."""
    jumps = 0.0 if jump is None else JUMPS
    listed: list[tuple[Any, float]] = [(DEMove(), 1.0 - jumps - SWAPS), (DEMove(gamma0=1.0), SWAPS)]
    if jump is not None:
        listed.append((MHMove(jump.propose), jumps))
    return listed
