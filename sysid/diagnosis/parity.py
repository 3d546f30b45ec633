r"""Parity of a loop: four kinds of force that no model is needed to tell apart.

On a steady sinusoid x = A sin φ two symmetries are exact.  H, half a cycle later (φ → φ + π),
mirrors the motion; R, time reversal (φ → π − φ), returns every place with opposite velocity.  Any
loop is the sum of four parts, each even or odd under H and conservative (even under R) or
dissipative (odd under R):

    OD  friction, viscous and yield forces        OC  springs, masses, delay of the force
    ED  position-dependent friction               EC  offsets, asymmetric gain, gas pressure
"""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.effects.base import Parity

PARITIES: Final[tuple[Parity, ...]] = ("OD", "OC", "ED", "EC")


def split_by_parity(
    loops: Float[np.ndarray, "loop phase"],
) -> dict[Parity, Float[np.ndarray, "loop phase"]]:
    """The four parts of each loop; they add up to it and are orthogonal.

    Args:
        loops: [L, J] on φ_j = 2πj/J, J even.

    Raises:
        ValueError: J is odd.
    """
    points = loops.shape[1]
    if points % 2:
        raise ValueError(f"{points} phase points: half a cycle later falls between two of them")
    later = np.roll(loops, -points // 2, axis=1)
    reversal = (points // 2 - np.arange(points)) % points
    parts: dict[Parity, np.ndarray] = {}
    for parity in PARITIES:
        half = 0.5 * (loops - later if parity[0] == "O" else loops + later)
        sign = 1.0 if parity[1] == "C" else -1.0
        parts[parity] = 0.5 * (half + sign * half[:, reversal])
    return parts


def parity_shares(loops: Float[np.ndarray, "loop phase"]) -> dict[Parity, float]:
    """Share of the energy Σ F² in each part; they add up to 1 (all 0 for loops of zeros)."""
    energies: dict[Parity, float] = {
        p: float(np.sum(part**2)) for p, part in split_by_parity(loops).items()
    }
    total = sum(energies.values())
    return {p: energy / total if total else 0.0 for p, energy in energies.items()}
