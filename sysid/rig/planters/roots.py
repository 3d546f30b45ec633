"""Roots of rising functions, all elements of an array at once."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

Values = Float[np.ndarray, "..."]

_ROUNDS = 60


def rising_root(
    function: Callable[[Values], Values], low: Values, high: Values, tolerance: float = 1e-9
) -> Values:
    """Where a rising function crosses zero, element by element (false position, Illinois rule).

    An element whose function does not change sign between the bounds gets the nearer bound.

    Args:
        function: [...] → [...], rising in each element.
        low: [...].
        high: [...].
        tolerance: On the width of the bracket, relative to the first one.
    """
    below, above = function(low), function(high)
    outside = np.where(below >= 0.0, low, high)
    inside = (below < 0.0) & (above > 0.0)
    enough = tolerance * np.maximum(high - low, 0.0)
    root = low
    for turn in range(_ROUNDS):
        spread = np.where(above - below > 0.0, above - below, 1.0)
        falsi = (low * above - high * below) / spread
        middle = 0.5 * (low + high)
        root = middle if turn % 4 == 3 else np.clip(falsi, low, high)
        value = function(root)
        rises = value < 0.0
        low, high = np.where(rises, root, low), np.where(rises, high, root)
        above = np.where(rises, 0.5 * above, value)
        below = np.where(rises, value, 0.5 * below)
        if np.all((high - low <= enough) | (np.abs(value) < 1e-9) | ~inside):
            break
    return np.where(inside, root, outside)
