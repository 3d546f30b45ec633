"""Structural misfit: smooth departures of a damper from the laws of the fitted model."""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.rig.planters.valve import LawFactors

PerLoop = Float[np.ndarray, " loop"]

_WAVES: Final = 60
_LENGTH: Final = 0.6
"""Correlation length, as a share of the range of each coordinate."""
_RANGES: Final = ((2.5e-3, 75e-3), (0.1, 15.0), (0.0, 0.4))
"""Amplitude m, frequency Hz, current A."""
_SMALLEST: Final = 0.05


def law_factors(
    size: float, amplitude: PerLoop, frequency: PerLoop, current: PerLoop, seed: int
) -> LawFactors:
    """1 + ε g for the laws F_t, C_i, v_h and k_v, each with a g of its own.

    g is a Gaussian random field with unit variance and squared-exponential covariance in log A,
    log f and i, drawn by random Fourier features.  The same seed gives the same g for every ε.

    Args:
        size: ε.
        amplitude: [L] m.
        frequency: [L] Hz.
        current: [L] A.
        seed: Of the four fields.
    """
    low, high = (np.array(ends) for ends in zip(*_RANGES, strict=True))
    span = [np.log(high[0] / low[0]), np.log(high[1] / low[1]), high[2]]
    place = np.stack(
        [np.log(amplitude / low[0]), np.log(frequency / low[1]), current], axis=1
    ) / np.array(span)
    random = np.random.default_rng(seed)
    factors = []
    for _ in range(4):
        waves = random.normal(size=(3, _WAVES)) / _LENGTH
        phases = random.uniform(0.0, 2.0 * np.pi, _WAVES)
        g = np.sqrt(2.0 / _WAVES) * np.cos(place @ waves + phases).sum(axis=1)
        factors.append(np.maximum(1.0 + size * g, _SMALLEST)[:, None])
    return LawFactors(*factors)
