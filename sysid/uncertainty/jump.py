r"""A density that walkers jump to: a mixture of Student t densities that fits draws.

    q(u) = Σ_k w_k t_ν(u; μ_k, L_k L_kᵀ)

In value-type coordinates posteriors are nearly normal and one component does.  Where the data leave
a parameter open, two coordinates make a bent ridge (a_3 with I_1 at currents up to where the law
saturates, say): one component then has to be so wide that jumps are seldom accepted and walkers at
the ends of the ridge wait for long.  A few components follow it.

The components are found by expectation-maximisation of normal densities, each covariance drawn
towards that of all draws by as much as `HELD` draws a dimension would, so that a component of few
draws is no needle.  How many there are is the smallest number that gives walkers which it was not
fitted to about the highest probability.

Source:
    Dempster, Laird and Rubin, JRSS B 39 (1977): the algorithm.  Fraley and Raftery, Journal of
    Classification 24 (2007): its covariances with a prior.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.linalg import solve_triangular

FREEDOM: Final = 8.0
"""Degrees of freedom of each t density: tails heavier than a posterior's, or walkers out there
would stay for long."""
COMPONENTS: Final = (1, 2, 4, 8, 12)
"""Numbers of components that are tried."""
HELD: Final = 2.0
"""Draws a dimension that the covariance of all draws stands for in each component."""
NARROWER: Final = 0.5
"""Variance that a component without draws would have, of that of all draws."""
DRAWS: Final = 12_000
"""Draws at most that a density is fitted to."""
WORTH: Final = 0.02
"""Log-probability a draw by which more components must be better."""
_ROUNDS: Final = 40
_GAINED: Final = 1e-3
"""Log-probability a draw that a round must gain for another one to follow."""
_JITTER: Final = 1e-10


@dataclass(frozen=True)
class Jump:
    """A mixture of K Student t densities in n dimensions.

    Attributes:
        weight: [K] shares, of sum one.
        mean: [K, n].
        root: [K, n, n] lower triangles L, LLᵀ the scale matrices.
    """

    weight: Float[np.ndarray, " K"]
    mean: Float[np.ndarray, "K n"]
    root: Float[np.ndarray, "K n n"]

    def draw(
        self, count: int, random: np.random.RandomState | np.random.Generator
    ) -> Float[np.ndarray, "count n"]:
        """Draws u."""
        which = random.choice(self.weight.size, size=count, p=self.weight)
        z = random.standard_normal((count, self.mean.shape[1]))
        spread = np.sqrt(FREEDOM / random.chisquare(FREEDOM, (count, 1)))
        return self.mean[which] + np.einsum("kij,kj->ki", self.root[which], z * spread)

    def log_density(self, u: Float[np.ndarray, "count n"]) -> Float[np.ndarray, " count"]:
        """Logarithm of q(u) up to a constant, the same for all densities of n dimensions."""
        away = (u - self.mean[:, None]) @ self._white
        square = np.sum(away**2, axis=2)
        each = 0.5 * (FREEDOM + u.shape[1]) * np.log1p(square / FREEDOM)
        return np.logaddexp.reduce(self._log_height[:, None] - each, axis=0)

    def propose(
        self, u: Float[np.ndarray, "count n"], random: np.random.RandomState
    ) -> tuple[Float[np.ndarray, "count n"], Float[np.ndarray, " count"]]:
        """Places to go to, and ln q(u)/q(u') of each."""
        there = self.draw(len(u), random)
        here, then = np.split(self.log_density(np.concatenate([u, there])), 2)
        return there, here - then

    @cached_property
    def _white(self) -> Float[np.ndarray, "K n n"]:
        """L⁻ᵀ of each component."""
        eye = np.eye(self.mean.shape[1])
        return np.array([solve_triangular(one, eye, lower=True).T for one in self.root])

    @cached_property
    def _log_height(self) -> Float[np.ndarray, " K"]:
        return np.log(self.weight) - _log_volume(self.root)


def jump_of(mean: Float[np.ndarray, " n"], covariance: Float[np.ndarray, "n n"]) -> Jump:
    """One t density of a mean and a scale matrix, which may be nearly singular."""
    return Jump(np.ones(1), np.array(mean)[None], _root(covariance)[None])


def jump_fitted(draws: Float[np.ndarray, "draw n"]) -> Jump:
    """The t density that fits draws: their mean and covariance."""
    return jump_of(draws.mean(axis=0), np.cov(draws, rowvar=False).reshape((draws.shape[1],) * 2))


def mixture_fitted(walked: Float[np.ndarray, "step walker n"], random: np.random.Generator) -> Jump:
    """The mixture that fits draws, of as many components as other walkers' draws speak for.

    Args:
        walked: [t, w, n] places; the first half of the walkers is of other ensembles than the
            second.
        random: Where components begin.

    Returns:
        In the coordinates of the draws.
    """
    every = max(1, walked.shape[0] * walked.shape[1] // DRAWS)
    thinned = walked[::every]
    n = walked.shape[2]
    flat = thinned.reshape(-1, n)
    centre, root = flat.mean(axis=0), _root(np.cov(flat, rowvar=False).reshape(n, n))
    white = solve_triangular(root, (thinned - centre).reshape(-1, n).T, lower=True).T
    white = white.reshape(thinned.shape)
    half = walked.shape[1] // 2
    scores = []
    for count in COMPONENTS:
        parts = (white[:, :half].reshape(-1, n), white[:, half:].reshape(-1, n))
        halves = (parts, parts[::-1])
        scores.append(
            np.mean([_mixture(one, count, random).log_density(other) for one, other in halves])
        )
    fewest = int(np.argmax(np.array(scores) > max(scores) - WORTH))
    best = _mixture(white.reshape(-1, n), COMPONENTS[fewest], random)
    return Jump(best.weight, centre + best.mean @ root.T, root @ best.root)


def _mixture(z: Float[np.ndarray, "draw n"], count: int, random: np.random.Generator) -> Jump:
    """Components of whitened draws."""
    n = z.shape[1]
    weight, mean = np.full(count, 1.0 / count), z[random.choice(len(z), count, replace=False)]
    root = np.repeat(np.eye(n)[None], count, axis=0)
    if count == 1:
        return Jump(weight, z.mean(axis=0)[None], root)
    reached = -np.inf
    for _ in range(_ROUNDS):
        size = _log_volume(root)
        each = np.array(
            [np.log(weight[k]) - 0.5 * _square(z, mean[k], root[k]) - size[k] for k in range(count)]
        )
        density = np.logaddexp.reduce(each, axis=0)
        if density.mean() < reached + _GAINED:
            break
        reached = density.mean()
        share = np.exp(each - density)
        drawn = share.sum(axis=1)
        weight = (drawn + 1.0) / (drawn.sum() + count)
        mean = (share @ z) / np.maximum(drawn, 1e-9)[:, None]
        for k in range(count):
            away = z - mean[k]
            scatter = (share[k][:, None] * away).T @ away + HELD * n * NARROWER * np.eye(n)
            root[k] = np.linalg.cholesky(scatter / (drawn[k] + HELD * n))
    return Jump(weight, mean, root)


def _square(u: np.ndarray, mean: np.ndarray, root: np.ndarray) -> np.ndarray:
    return np.sum(solve_triangular(root, (u - mean).T, lower=True) ** 2, axis=0)


def _log_volume(root: Float[np.ndarray, "K n n"]) -> Float[np.ndarray, " K"]:
    return np.sum(np.log(np.diagonal(root, axis1=1, axis2=2)), axis=1)


def _root(covariance: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    scale = np.sqrt(np.maximum(np.diagonal(covariance), 1e-300))
    correlation = covariance / scale[:, None] / scale[None, :]
    return scale[:, None] * np.linalg.cholesky(correlation + _JITTER * np.eye(len(scale)))
