"""Half widths of intervals from several Student's t distributions with one centre."""

from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.special import stdtr, stdtrit

HALVINGS: Final = 60
"""Of the bracket between the narrowest and the widest: to rounding."""


def half_width(
    weight: Float[np.ndarray, " each"],
    sd: Float[np.ndarray, "each n"],
    freedom: Float[np.ndarray, "each n"],
    level: float,
) -> Float[np.ndarray, " n"]:
    """Half width x in which a mixture of t distributions has a share `level` of its mass.

        Σ_e w_e T_ν(x / sd_e) = (1 + level) / 2,   T_ν: cumulative distribution of Student's t

    Args:
        weight: [e] shares of the distributions; together one.
        sd: [e, n] their scales, above zero.
        freedom: [e, n] their degrees of freedom, ν.
        level: Share of the mass within ±x.
    """
    inside = 0.5 + level / 2
    alone = sd * stdtrit(freedom, inside)
    low, high = alone.min(axis=0), alone.max(axis=0)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        short = weight @ stdtr(freedom, middle / sd) < inside
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return 0.5 * (low + high)
