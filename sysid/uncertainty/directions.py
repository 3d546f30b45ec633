"""What some information says something about, and what it says nothing about."""

from typing import Final, NamedTuple

import numpy as np
from jaxtyping import Float

SINGULAR: Final = 1e-11
"""Eigenvalue of the correlation-scaled information below which rounding is all there is."""
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
    vector = vector / scale[:, None]
    open_ones = vector[:, ~known]
    return Directions(
        vector[:, known] / np.sqrt(value[known]),
        open_ones * (OPEN_FACTOR / np.max(np.abs(open_ones), axis=0, initial=0.0)),
    )
