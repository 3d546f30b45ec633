r"""Decoys: how high do signatures score that are nobody's cause?

The threshold of the score test counts on Σ.  Where Σ is too small, or of the wrong form, whatever is
smooth scores: signatures drawn at random as much as those of the catalogue.  So random ones are
sent through the same machinery,

    g_l(φ) = A_l^α f_l^β |i_l|^γ p(φ) {1, F_l(φ)},

p a random sum of harmonics of one parity or of all, and the threshold rises to what they reach by
chance.  It must hold for all candidates together, that is, at a tail probability of 10⁻⁴, which
no affordable number of decoys shows: a generalised Pareto distribution, fitted to the highest tenth
of their scores, continues it.

Source:
    Hosking & Wallis, Technometrics 29 (1987) 339: the fit by probability-weighted moments.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.discrepancy import Covariance
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.reml import full_rank

DECOYS: Final = 1500
HARMONICS: Final = 7
"""Highest harmonic of a decoy; those of effects fall off, and so do these, as 1/n."""
STEEPEST: Final = 2.0
"""Largest exponent of A, f and |i|: that of inertia in f, of hydraulic losses in all."""
TAIL: Final = 0.1
"""Highest part of the scores, to which the tail is fitted."""


@dataclass(frozen=True)
class Decoys:
    """What decoys reached.

    Attributes:
        scores: [N], χ²₁ each if Σ is right.
    """

    scores: Float[np.ndarray, " decoy"]

    def quantile(self, level: float) -> float:
        """Score that a decoy exceeds with this probability."""
        if level >= TAIL:
            return float(np.quantile(self.scores, 1.0 - level))
        start = float(np.quantile(self.scores, 1.0 - TAIL))
        beyond = np.sort(self.scores[self.scores > start] - start)
        if beyond.size < 2:
            return start
        shape, scale = _pareto(beyond)
        ratio = TAIL / level
        grown = np.log(ratio) if abs(shape) < 1e-6 else (ratio**shape - 1.0) / shape
        return start + scale * float(grown)


def _pareto(beyond: Float[np.ndarray, " k"]) -> tuple[float, float]:
    """ξ and σ of 1 − (1 + ξy/σ)^(−1/ξ), from sorted excesses y by probability-weighted moments."""
    k = beyond.size
    mean = float(beyond.mean())
    weighted = float(np.mean(beyond * (1.0 - (np.arange(1, k + 1) - 0.35) / k)))
    shape = 2.0 - mean / (mean - 2.0 * weighted)
    return shape, 2.0 * mean * weighted / (mean - 2.0 * weighted)


def draw(
    evidence: Evidence,
    residual: Float[np.ndarray, "loop m"],
    count: int = DECOYS,
    seed: int = 0,
) -> Float[np.ndarray, "loop m n"]:
    """Random smooth signatures in harmonics, [L, m, N]; the second half times the model's force.

    With the measured force a decoy would hold the residual itself and score as a cause.

    Args:
        evidence: The campaign.
        residual: [L, m] N, measured minus model.
        count: N, even.
        seed: Of the draw.
    """
    rng = np.random.default_rng(seed)
    loops, columns = evidence.loops, np.asarray(evidence.columns)
    points = columns.shape[0]
    pattern = patterns(rng, count, 2.0 * np.pi * np.arange(points) / points)
    power = rng.uniform(0.0, STEEPEST, (3, count)) * rng.integers(0, 2, (3, count))
    current = np.abs(np.nan_to_num(loops.current))
    size = np.ones((loops.amplitude.size, count))
    for values, exponent in zip((loops.amplitude, loops.frequency, current), power, strict=True):
        size *= (values / (values.max() or 1.0))[:, None] ** exponent
    plain = pattern[:, : count // 2].T @ columns
    force = (evidence.measured - residual) @ columns.T * points
    times = force[:, :, None] * pattern[None, :, count // 2 :]
    every = np.empty((size.shape[0], columns.shape[1], count))
    every[:, :, : count // 2] = plain.T
    every[:, :, count // 2 :] = columns.T @ times / np.abs(force).max()
    return every * size[:, None, :]


def patterns(
    rng: np.random.Generator, count: int, phase: Float[np.ndarray, " point"]
) -> Float[np.ndarray, "point n"]:
    """Random sums of harmonics: of each of the four parities in turn, then of all.

    With x = A sin φ, odd sines are OC, odd cosines OD, even cosines EC and even sines ED.
    """
    n = np.arange(HARMONICS + 1)
    waves = np.concatenate([np.cos(np.outer(phase, n)), np.sin(np.outer(phase, n[1:]))], axis=1)
    order = np.concatenate([n, n[1:]])
    cosine = np.arange(order.size) <= HARMONICS
    odd = order % 2 == 1
    kinds = [odd & cosine, odd & ~cosine, ~odd & cosine, ~odd & ~cosine, np.full(order.size, True)]
    allowed = np.stack([kinds[k % len(kinds)] for k in range(count)], axis=1)
    weight = rng.standard_normal((order.size, count)) / np.maximum(order, 1)[:, None]
    return waves @ (weight * allowed)


def score_decoys(
    signatures: Float[np.ndarray, "loop m n"],
    residual: Float[np.ndarray, "loop m"],
    jacobian: Float[np.ndarray, "loop m p"],
    covariance: Covariance,
) -> Decoys:
    """Scores of decoys, as `scores.score_all` has those of candidates.

    Args:
        signatures: [L, m, N].
        residual: [L, m] N, measured minus model.
        jacobian: [L, m, p] of the model.
        covariance: Σ.
    """
    solid = full_rank(jacobian)
    known = np.concatenate([solid, residual[:, :, None]], axis=2)
    squares, across = covariance.squares(signatures, known)
    gram = covariance.inner(known, known)
    n = solid.shape[2]
    coupled = np.linalg.solve(gram[:n, :n], np.column_stack([across[:n], gram[:n, n]]))
    along = across[n] - across[:n].T @ coupled[:, -1]
    after = squares - np.sum(across[:n] * coupled[:, :-1], axis=0)
    usable = after > SURVIVES * squares
    return Decoys(along[usable] ** 2 / after[usable])


SURVIVES: Final = 0.002
"""As `scores.INVISIBLE`: decoys that the model absorbs are no decoys."""
