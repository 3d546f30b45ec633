r"""Decoys: would a force that no effect of the catalogue has explain what is left?

Random smooth signatures are sent through the machinery of the score test (`scores`),

    g_l(φ) = A_l^α f_l^β |i_l|^γ p(φ) {1, F_l(φ)},

p a random sum of harmonics, of one parity or of all.  If the model is right and Σ is that of noise,
rig and laws, each of their scores is χ²₁, and the highest of 1 500 is about 12.  If the cause is
not in the catalogue, what stood in for it leaves much that is smooth, and some decoy finds it.

That is what they are used for: beside the effects that were found, not as a threshold for them.
As a threshold at the tail probability that all candidates share they would judge candidates by
their rivals: random signatures are many enough that one is like the true effect, scores nearly as
much, and cuts it.
"""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.state import State
from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.reml import full_rank

DECOYS: Final = 1500
HARMONICS: Final = 7
"""Highest harmonic of a decoy; those of effects fall off, and so do these, as 1/n."""
STEEPEST: Final = 2.0
"""Largest exponent of A, f and |i|: that of inertia in f, of hydraulic losses in both."""
SURVIVES: Final = 0.002
"""As `scores.INVISIBLE`: of decoys that the model absorbs only rounding is left."""

STRANGE: Final = 25.0
"""Log-likelihood from which a decoy says that something acts which no effect is.  If all is
explained, the best of 1 500 gains about 6, and about 12 where errors of the laws are not quite as Σ
has them."""


def strangest(evidence: Evidence, state: State, seed: int = 0) -> float:
    """Log-likelihood that the best decoy would gain beside a model; 0 where Σ was not fitted.

    Args:
        evidence: The campaign.
        state: The model with its effects.
        seed: Of the decoys.
    """
    if state.sizes == NONE:
        return 0.0
    residual = state.gls.residual
    signatures = draw(evidence, residual, seed=seed)
    scores = score_decoys(signatures, residual, state.gls.jacobian, state.covariance)
    return 0.5 * float(scores.max(initial=0.0))


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
    every[:, :, count // 2 :] = columns.T @ times / (np.abs(force).max() or 1.0)
    return every * size[:, None, :]


def patterns(
    rng: np.random.Generator, count: int, phase: Float[np.ndarray, " point"]
) -> Float[np.ndarray, "point n"]:
    """Random sums of harmonics: of each of the four parities in turn, then of all.

    With x = A sin φ, odd sines are OC, odd cosines OD, even cosines EC and even sines ED.

    Args:
        rng: Of the coefficients.
        count: n, number of sums.
        phase: [J] rad, φ.
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
) -> Float[np.ndarray, " decoy"]:
    """Scores of the decoys that the model does not absorb; χ²₁ each if Σ is right.

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
    return along[usable] ** 2 / after[usable]
