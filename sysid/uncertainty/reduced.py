r"""The likelihood of loops in a few dozen numbers, without its covariance.

Simulated loops of all plausible parameters lie close to a low-dimensional space: the tangent space
of the model, and a little more for its curvature.  With r₀ the residual at one place and δ_k the
changes of the simulated loops at training draws, all in harmonics, and WᵀW = Σ⁻¹,

    W [r₀ δ_1 δ_2 …] = Q S Vᵀ,

the first q columns of Q carry all but a negligible part, r₀ wholly.  Then

    rᵀΣ⁻¹r ≈ ρ + ‖a − Bᵀf‖²,   B = C Σ⁻¹W⁻¹Q = C Σ⁻¹X,   a = Xᵀ Σ⁻¹ y,

f the force at the points that are simulated, C from points to harmonics, y measured.  Beside them
stand the numbers s = Gᵀr of `doubt`, as further columns.  What is
neglected is ‖(1 − QQᵀ) W δ‖², the part of a simulated loop outside of the space: it never makes a
place less probable than it is, and what it changes is measured on the draws themselves.

The same draws tell more.  A model without memory can be computed at any points alone, and what its
force is at some two hundred of all points tells Bᵀf to many digits: Bᵀf ≈ Mᵀ f_S + b, with S found
by pivoting and M by least squares.

Source:
    Points from pivots: Drmač and Gugercin, SIAM Journal on Scientific Computing 38 (2016), the
    "Q-DEIM" of empirical interpolation.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float, Int
from scipy.linalg import qr

from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.observed import Observed

NEGLECTED: Final = 1e-3
"""Mean over training draws of what is neglected of rᵀΣ⁻¹r."""
FEW: Final = 256
"""Points that a model without memory is computed at."""
APART: Final = 3
"""They are first looked for among every so manieth point, at a part of the cost."""
MANY: Final = 20
"""Points to each that is chosen, from which on only some are looked at first."""
ROWS: Final = 128
"""The last point is repeated, for nothing, up to a multiple of so many: programs are compiled for a
number of points, and how many training draws there are, and so points, is chance."""
TOLD: Final = 2e-3
"""Largest error of Bᵀf at these, for draws that they were not chosen by: in standard deviations of
the data, or relative where Bᵀf changes by more than one."""
HELD: Final = 5
RCOND: Final = 1e-11


@dataclass(frozen=True)
class Reduced:
    """The quadratic form in few numbers.

    Attributes:
        B: [s, n + q], the columns of Gᵀr first.
        a: [n + q].
        rest: ρ.
        points: [s] which of the L·P points that are simulated; all of them, or a few.
    """

    B: Float[np.ndarray, "points columns"]
    a: Float[np.ndarray, " columns"]
    rest: float
    points: Int[np.ndarray, " points"]


def reduce_likelihood(
    observed: Observed,
    covariance: Covariance,
    centre: Float[np.ndarray, "loop m"],
    draws: Float[np.ndarray, "draw loop m"],
    beside: Float[np.ndarray, "loop m n"],
    *,
    neglected: float = NEGLECTED,
) -> Reduced:
    """Find the space.

    Args:
        observed: Measured loops.
        covariance: Σ.
        centre: [L, m] N, harmonics of the loops simulated at one place.
        draws: [K, L, m] N, at the training draws.
        beside: [L, m, n] G.
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
    weighted = np.concatenate([beside, covariance.weighted(X)], axis=2)
    a = np.einsum("lmq,lm->q", weighted, observed.measured)
    B = np.einsum("pm,lmq->lpq", np.asarray(observed.columns), weighted)
    along = np.einsum("lmq,lm->q", weighted[:, :, beside.shape[2] :], start)
    rest = float(np.sum(white[:, 0] ** 2) - np.sum(along**2))
    B = B.reshape(-1, weighted.shape[2])
    return Reduced(B, a, rest, np.arange(len(B)))


def at_few_points(
    reduced: Reduced, forces: Float[np.ndarray, "draw points"], count: int = FEW
) -> Reduced | None:
    """The same at few points, for models without memory; None where few do not tell enough.

    Args:
        reduced: At all points.
        forces: [K, L·P] N, at training draws.
        count: How many points.
    """
    count = min(count, len(forces) // 2, len(reduced.B))
    every = np.arange(len(reduced.B))
    found = None
    if every.size > MANY * count:
        found = _at_few_among(reduced, forces, count, every[::APART])
    return _at_few_among(reduced, forces, count, every) if found is None else found


def _at_few_among(
    reduced: Reduced,
    forces: Float[np.ndarray, "draw points"],
    count: int,
    among: Int[np.ndarray, " candidates"],
) -> Reduced | None:
    """The same at some of these points.

    Every fifth draw is left out of the least squares and must be predicted.
    """
    mean = forces.mean(axis=0)
    away = forces - mean
    wanted = away @ reduced.B
    held = np.arange(len(forces)) % HELD == 0
    # a few random mixtures of the draws have the same pivots as all of them, at a part of the cost
    size = np.maximum(np.linalg.norm(wanted, axis=1), 1.0)
    scaled = away / size[:, None]
    mixed = np.random.default_rng(0).standard_normal((count, len(forces))) @ scaled[:, among]
    pivots = qr(mixed, mode="r", pivoting=True, check_finite=False)[-1]
    points = among[np.sort(np.asarray(pivots, dtype=int)[:count])]
    known = scaled[~held][:, points]
    M = np.linalg.lstsq(known, wanted[~held] / size[~held, None], rcond=RCOND)[0]
    error = np.sqrt(np.sum((away[held][:, points] @ M - wanted[held]) ** 2, axis=1))
    if float(np.max(error / size[held])) > TOLD:
        return None
    start = mean @ reduced.B - mean[points] @ M
    more = -count % ROWS
    if count + more >= len(reduced.B):
        more = 0  # as many as there are would be taken for all of them
    M = np.pad(M, ((0, more), (0, 0)))
    return Reduced(M, reduced.a - start, reduced.rest, np.pad(points, (0, more), mode="edge"))
