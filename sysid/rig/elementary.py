"""Exponential, logarithm, sine and hyperbolic tangent made of exactly rounded operations only.

The mathematics library of one machine differs from another's in the last digit of `exp` or `sin`,
and numpy's vector code differs with the processor.  Data that must be rebuilt byte for byte cannot
rest on them.  Additions, multiplications and divisions are rounded the same way everywhere (IEEE
754), so series built of them give the same bits on every machine.  Accuracy is about 1e-16 of the
largest value on the range used.
"""

import math
from typing import Final

import numpy as np
from jaxtyping import Float

Values = Float[np.ndarray, "..."]

_LN2_HIGH: Final = 6.93147180369123816490e-01
_LN2_LOW: Final = 1.90821492927058770002e-10
"""ln 2 in two parts: multiples of the first are exact for |k| < 2048."""
_LN10: Final = 2.302585092994046
_TWO_PI: Final = 6.283185307179586


def exp(x: Values) -> Values:
    """e^x = 2^k e^r with |r| ≤ ln 2 / 2, the second factor by its Taylor series.

    Args:
        x: [...], magnitude below 700.
    """
    k = np.rint(x / (_LN2_HIGH + _LN2_LOW))
    r = (x - k * _LN2_HIGH) - k * _LN2_LOW
    series = np.ones_like(r)
    for n in range(14, 0, -1):
        series = 1.0 + r * series / n
    return np.ldexp(series, k.astype(np.int64))


def log10(x: float) -> float:
    """Decimal logarithm, by the series of 2 artanh((m − 1)/(m + 1)) for x = m 2^k.

    Args:
        x: Positive.
    """
    m, k = math.frexp(x)
    if m < 0.7071067811865476:
        m, k = 2.0 * m, k - 1
    s = (m - 1.0) / (m + 1.0)
    square, series = s * s, 0.0
    for n in range(25, 0, -2):
        series = 1.0 / n + square * series
    return (2.0 * s * series + k * _LN2_LOW + k * _LN2_HIGH) / _LN10


def sine(turns: Values) -> Values:
    """Sine of 2π·turns; exactly 0 at whole and half turns.

    Args:
        turns: [...] angle in whole turns.
    """
    quarter = np.rint(4.0 * turns)
    r = _TWO_PI * (turns - 0.25 * quarter)
    square = r * r
    odd, even = np.ones_like(r), np.ones_like(r)
    for n in range(9, 0, -1):
        odd = 1.0 - square * odd / (2 * n * (2 * n + 1))
        even = 1.0 - square * even / (2 * n * (2 * n - 1))
    odd = r * odd
    which = quarter - 4.0 * np.floor(0.25 * quarter)
    return np.select([which == 0, which == 1, which == 2], [odd, even, -odd], -even)


def cosine(turns: Values) -> Values:
    """Cosine of 2π·turns, turns [...]."""
    return sine(turns + 0.25)


def tanh_half(z: Values) -> Values:
    """tanh(z/2) = (1 − e^−z) / (1 + e^−z), z [...]."""
    small = exp(-np.minimum(np.abs(z), 80.0))
    return np.sign(z) * (1.0 - small) / (1.0 + small)


def logistic(z: Values) -> Values:
    """1 / (1 + e^−z), z [...]."""
    return 0.5 * (1.0 + tanh_half(z))
