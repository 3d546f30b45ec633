"""Angle of a point, made of exactly rounded operations only, as those of `elementary`."""

from typing import Final

import numpy as np
from jaxtyping import Float

Values = Float[np.ndarray, "..."]

_HALF_PI: Final = 1.5707963267948966
_HALVINGS: Final = 3
_LAST: Final = 21
"""Power of the series' last term: below 1e-21 after three halvings."""


def angle(opposite: Values, adjacent: Values) -> Values:
    """arctan(opposite / adjacent), rad from 0 to π/2; 0 where both are 0.

    The angle is halved three times by tan(θ/2) = t / (1 + √(1 + t²)), and then found by Taylor's
    series.  Square roots are rounded exactly, as sums, products and quotients are.

    Args:
        opposite: [...], not negative.
        adjacent: [...], not negative.
    """
    steep = opposite > adjacent
    longer = np.where(steep, opposite, adjacent)
    shorter = np.where(steep, adjacent, opposite)
    tangent = shorter / np.where(longer > 0.0, longer, 1.0)
    for _ in range(_HALVINGS):
        tangent = tangent / (1.0 + np.sqrt(1.0 + tangent * tangent))
    square, series = tangent * tangent, np.zeros_like(tangent)
    for power in range(_LAST, 0, -2):
        series = 1.0 / power - square * series
    small = 2.0**_HALVINGS * tangent * series
    return np.where(steep, _HALF_PI - small, small)
