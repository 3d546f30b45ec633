r"""Loops in few numbers: orthonormal harmonics of each loop.

Residuals, Jacobians and signatures of effects are compared in harmonics 0 … H of the phase, 2H + 1
numbers a loop instead of hundreds of correlated points.  The basis is orthonormal for the mean
over phase: Σ of squares is the mean square of what is kept.  Even harmonics carry what differs
between the two half cycles, odd ones the rest.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float, Int

HARMONICS: Final = 15


@dataclass(frozen=True)
class HarmonicBasis:
    """Columns 1, √2 cos φ, √2 sin φ, √2 cos 2φ, … on a phase grid.

    Attributes:
        columns: [J, m], columnsᵀ columns = J·1, m = 2H + 1.
        order: [m] harmonic of each column.
    """

    columns: Float[np.ndarray, "phase m"]
    order: Int[np.ndarray, " m"]

    def compress(self, loops: Float[np.ndarray, "... phase"]) -> Float[np.ndarray, "... m"]:
        """Coefficients of loops on the grid, [..., m]."""
        return np.asarray(loops) @ self.columns / self.columns.shape[0]


def harmonic_basis(points: int, harmonics: int = HARMONICS) -> HarmonicBasis:
    """The basis on φ_j = 2πj/J.

    Args:
        points: J; must exceed 2·harmonics.
        harmonics: H.

    Raises:
        ValueError: The grid is too coarse for so many harmonics.
    """
    if points <= 2 * harmonics:
        raise ValueError(f"{points} phase points cannot carry {harmonics} harmonics")
    phase = 2.0 * np.pi * np.arange(points) / points
    n = np.arange(1, harmonics + 1)
    waves = np.sqrt(2.0) * np.stack(
        [np.cos(np.outer(phase, n)), np.sin(np.outer(phase, n))], axis=2
    )
    columns = np.concatenate([np.ones((points, 1)), waves.reshape(points, -1)], axis=1)
    return HarmonicBasis(columns, np.concatenate([[0], np.repeat(n, 2)]))
