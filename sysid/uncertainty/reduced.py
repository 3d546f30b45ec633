r"""The likelihood of loops in a few dozen numbers, without its covariance.

Simulated loops of all plausible parameters lie close to a low-dimensional space: the tangent space
of the model, and a little more for its curvature.  With r₀ the residual at one place and δ_k the
changes of the simulated loops at training draws, all in harmonics, and WᵀW = Σ⁻¹,

    W [r₀ δ_1 δ_2 …] = Q S Vᵀ,

the first q columns of Q carry all but a negligible part, r₀ wholly.  Then

    rᵀΣ⁻¹r ≈ ρ + ‖a − Bᵀf‖²,   B = C Σ⁻¹W⁻¹Q = C Σ⁻¹X,   a = Xᵀ Σ⁻¹ y,

f the force at the points that are simulated, C from points to harmonics, y measured.  What is
neglected is ‖(1 − QQᵀ) W δ‖², the part of a simulated loop outside of the space: it never makes a
place less probable than it is, and what it changes is measured on the draws themselves.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.observed import Observed

NEGLECTED: Final = 1e-3
"""Mean over training draws of what is neglected of rᵀΣ⁻¹r."""


@dataclass(frozen=True)
class Reduced:
    """The quadratic form in few numbers.

    Attributes:
        B: [L·P, q].
        a: [q].
        rest: ρ.
    """

    B: Float[np.ndarray, "points q"]
    a: Float[np.ndarray, " q"]
    rest: float


def reduce_likelihood(
    observed: Observed,
    covariance: Covariance,
    centre: Float[np.ndarray, "loop m"],
    draws: Float[np.ndarray, "draw loop m"],
    *,
    neglected: float = NEGLECTED,
) -> Reduced:
    """Find the space.

    Args:
        observed: Measured loops.
        covariance: Σ.
        centre: [L, m] N, harmonics of the loops simulated at one place.
        draws: [K, L, m] N, at the training draws.
        neglected: Mean over draws of what may be neglected of rᵀΣ⁻¹r.
    """
    start = observed.measured - centre
    all_of_it = np.concatenate([start[None], draws - centre])
    columns = np.moveaxis(all_of_it, 0, 2)
    white = covariance.whiten(columns)
    first = white[:, :1] / max(float(np.linalg.norm(white[:, 0])), 1e-300)
    others = white[:, 1:] - first @ (first.T @ white[:, 1:])
    # the small side of the matrix: draws, not data
    squares, turn = np.linalg.eigh(others.T @ others)
    squares, turn = np.maximum(squares[::-1], 0.0), turn[:, ::-1]
    beyond = np.append(np.cumsum(squares[::-1])[::-1], 0.0) / max(len(draws), 1)
    enough = (beyond <= neglected) | (
        np.append(squares, 0.0) <= 1e-13 * max(float(squares[0]), 1e-300)
    )
    q = int(np.argmax(enough))
    # combinations of the columns that are orthonormal once whitened
    mixing = np.zeros((columns.shape[2], q + 1))
    mixing[0, 0] = 1.0 / max(float(np.linalg.norm(white[:, 0])), 1e-300)
    mixing[1:, 1:] = turn[:, :q] / np.sqrt(squares[:q])
    mixing[0, 1:] = -mixing[0, 0] * (first.T @ white[:, 1:] @ mixing[1:, 1:])[0]
    X = columns @ mixing
    weighted = covariance.weighted(X)
    a = np.einsum("lmq,lm->q", weighted, observed.measured)
    B = np.einsum("pm,lmq->lpq", np.asarray(observed.columns), weighted)
    along = np.einsum("lmq,lm->q", weighted, start)
    rest = float(np.sum(white[:, 0] ** 2) - np.sum(along**2))
    return Reduced(B.reshape(-1, q + 1), a, rest)
