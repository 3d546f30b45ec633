"""What some information says something about, and what it says nothing about."""

from typing import Final, NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.linalg import qr

SINGULAR: Final = 1e-11
"""Eigenvalue of the correlation-scaled information below which rounding is all there is."""
ROUNDING: Final = 1e-8
"""Entry of an open direction, beside one of 1 in the scaled information, that is none."""
OPEN_FACTOR: Final = 1e4
"""Relative standard deviation that stands for "not at all determined"."""
ALONE: Final = 1e-3
"""Part of the information on a direction that must lie outside of a cluster, or nothing tells
whether that cluster errs there."""


class Directions(NamedTuple):
    """Directions of n parameters, whatever their magnitudes.

    Attributes:
        seen: [n, r] R with RᵀHR = 1: RRᵀ is the inverse of H where there is one.
        unseen: [n, n − r] their largest entry is OPEN_FACTOR, which is a standard deviation of
            parameters that are relative changes.
    """

    seen: Float[np.ndarray, "n r"]
    unseen: Float[np.ndarray, "n q"]


class Share(NamedTuple):
    """What one cluster of tests says of the directions that all clusters together see.

    Attributes:
        axes: [n, r] R with RᵀHR = 1 and RᵀH_cR diagonal, H_c the information of the cluster.
        part: [r] that diagonal: the cluster's part of the information on each axis, 0 to 1.
        score: [r] of the cluster, Rᵀs_c.
    """

    axes: Float[np.ndarray, "n r"]
    part: Float[np.ndarray, " r"]
    score: Float[np.ndarray, " r"]

    @property
    def told(self) -> Bool[np.ndarray, " r"]:
        """[r] others see the axis, too: more than `ALONE` of the information is theirs."""
        return 1.0 - self.part > ALONE

    def over_rest(self, values: Float[np.ndarray, " r"]) -> Float[np.ndarray, " r"]:
        """[r] values over the part of the others; zero where nothing is told."""
        return np.where(self.told, values / np.where(self.told, 1.0 - self.part, 1.0), 0.0)


def directions_of(information: Float[np.ndarray, "n n"]) -> Directions:
    """Directions that are seen and others, by the eigenvalues of the scaled information.

    Args:
        information: H, positive semidefinite.
    """
    diagonal = np.diagonal(information)
    acts = diagonal > 0.0
    scale = np.sqrt(diagonal[acts])
    among = information[np.ix_(acts, acts)] / scale[:, None] / scale[None, :]
    value, vector = np.linalg.eigh(among)
    known = value > SINGULAR
    open_ones = _apart(vector[:, ~known], scale) / scale[:, None]
    widest = np.max(np.abs(open_ones), axis=0, initial=0.0)
    seen = np.zeros((len(information), np.count_nonzero(known)))
    seen[acts] = vector[:, known] / scale[:, None] / np.sqrt(value[known])
    # what acts on nothing is a direction of its own: beside it, rounding would be all there is
    alone = OPEN_FACTOR * np.eye(len(information))[:, ~acts]
    among_open = np.zeros((len(information), open_ones.shape[1]))
    among_open[acts] = open_ones * (OPEN_FACTOR / widest)
    return Directions(seen, np.concatenate([among_open, alone], axis=1))


def shares_of(
    information: Float[np.ndarray, "cluster n n"], scores: Float[np.ndarray, "cluster n"]
) -> tuple[Share, ...]:
    """What each cluster says of the directions that are seen.

    Args:
        information: [C, n, n] H_c of each cluster, positive semidefinite.
        scores: [C, n] s_c, in the same parameters.
    """
    seen = directions_of(information.sum(axis=0)).seen
    found = []
    for own, score in zip(information, scores, strict=True):
        part, turn = np.linalg.eigh(seen.T @ own @ seen)
        found.append(Share(seen @ turn, part, turn.T @ (seen.T @ score)))
    return tuple(found)


def _apart(
    open_ones: Float[np.ndarray, "n q"], scale: Float[np.ndarray, " n"]
) -> Float[np.ndarray, "n q"]:
    """Another basis of what is not seen: each vector has an entry where the others have none.

    The eigenvectors mix all of it.  Scaled back, one of them would be all but along a parameter
    that acts on nothing, and what others trade among each other would be lost beside it.  So the
    parameters that act least have entries of their own, and none of them stands in all vectors.

    Args:
        open_ones: [n, q] orthonormal directions of the scaled information.
        scale: [n] √H_kk, by which each parameter acts.
    """
    if open_ones.shape[1] < 2:
        return open_ones
    sure = np.where(np.abs(open_ones) < ROUNDING, 0.0, open_ones)
    order = qr((sure / scale[:, None]).T, mode="economic", pivoting=True)[-1]
    pivots = order[: open_ones.shape[1]]
    basis = np.linalg.solve(open_ones[pivots].T, open_ones.T).T
    basis[np.abs(basis) < ROUNDING] = 0.0
    return basis
