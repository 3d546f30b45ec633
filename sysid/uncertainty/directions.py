"""What some information says something about, and what it says nothing about."""

from typing import Final, NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.linalg import qr

SINGULAR: Final = 1e-11
"""Eigenvalue of the correlation-scaled information below which rounding is all there is."""
ROUNDING: Final = 1e-8
"""Entry of an open direction, beside one of 1 in the scaled information, that is none."""
OPEN_FACTOR: Final = 1e4
"""Relative standard deviation that stands for "not at all determined"."""


class Directions(NamedTuple):
    """Directions of n parameters, whatever their magnitudes.

    Attributes:
        seen: [n, r] R with RᵀHR = 1: RRᵀ is the inverse of H where there is one.
        unseen: [n, n − r] their largest entry is OPEN_FACTOR, which is a standard deviation of
            parameters that are relative changes.
    """

    seen: Float[np.ndarray, "n r"]
    unseen: Float[np.ndarray, "n q"]


def directions_of(information: Float[np.ndarray, "n n"]) -> Directions:
    """Directions that are seen and others, by the eigenvalues of the scaled information.

    Args:
        information: H, positive semidefinite.
    """
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-300))
    value, vector = np.linalg.eigh(information / scale[:, None] / scale[None, :])
    known = value > SINGULAR
    open_ones = _apart(vector[:, ~known]) / scale[:, None]
    return Directions(
        vector[:, known] / scale[:, None] / np.sqrt(value[known]),
        open_ones * (OPEN_FACTOR / np.max(np.abs(open_ones), axis=0, initial=0.0)),
    )


def _apart(open_ones: Float[np.ndarray, "n q"]) -> Float[np.ndarray, "n q"]:
    """Another basis of what is not seen: each vector has an entry where the others have none.

    The eigenvectors mix all of it.  Scaled back, one of them would be all but along a parameter
    that acts on nothing, and what others trade among each other would be lost beside it.
    """
    if open_ones.shape[1] < 2:
        return open_ones
    order = qr(open_ones.T, mode="economic", pivoting=True)[-1]
    pivots = order[: open_ones.shape[1]]
    basis = np.linalg.solve(open_ones[pivots].T, open_ones.T).T
    basis[np.abs(basis) < ROUNDING] = 0.0
    return basis
