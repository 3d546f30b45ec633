"""Harmonics of a cyclic motion: found by least squares, differentiated exactly.

A loop's displacement is x(φ) = Σ Im(h_n e^{i n φ}), n = 1 … 15, so that h_1 = A makes the
fundamental A sin φ.  Velocity and acceleration follow by multiplying with i n ω; finite
differences are never taken.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

ORDER = 15
"""Highest displacement harmonic that a loop keeps."""

FALSE_HARMONIC = 0.01
"""Chance that noise alone lets any harmonic of one loop pass `significant`."""

Samples = Float[np.ndarray, " n"]
Harmonics = Complex[np.ndarray, " harmonic"]


@dataclass(frozen=True)
class HarmonicFit:
    """Least-squares harmonics of samples at known phases.

    Attributes:
        mean: Constant term, in the unit of the samples.
        harmonics: [n] complex amplitudes, x = mean + Σ Im(h_n e^{i n φ}).
        residual: [samples] what is left.
    """

    mean: float
    harmonics: Harmonics
    residual: Samples


def highest_order(samples_per_cycle: float) -> int:
    """The highest harmonic that so many samples a cycle can hold without aliasing."""
    return max(1, min(ORDER, int(np.ceil(0.5 * samples_per_cycle)) - 1))


def fit_harmonics(phase: Samples, values: Samples, order: int = ORDER) -> HarmonicFit:
    """Fit a constant and harmonics 1 … `order` to samples.

    Args:
        phase: [n] rad.
        values: [n] any unit.
        order: Highest harmonic.
    """
    turn = np.exp(1j * phase)
    basis = np.ones((2 * order + 1, phase.size))
    power = turn
    for n in range(1, order + 1):
        basis[n], basis[order + n] = np.imag(power), np.real(power)
        power = power * turn
    solution = np.linalg.lstsq(basis @ basis.T, basis @ values, rcond=None)[0]
    return HarmonicFit(
        mean=float(solution[0]),
        harmonics=solution[1 : order + 1] + 1j * solution[order + 1 :],
        residual=values - solution @ basis,
    )


def significant(harmonics: Harmonics, variance: Float[np.ndarray, " harmonic"]) -> Harmonics:
    """Set to zero the harmonics that noise alone would explain; the first always stays.

    A harmonic n of pure noise has |h_n|² exponentially distributed about its variance, so the
    threshold −ln(`FALSE_HARMONIC`/order) lets a false one through once in a hundred loops.
    Without it, the n² of the acceleration would blow up the noise of n = 15 by 225.

    Args:
        harmonics: [n] complex.
        variance: [n] expected |h_n|² of noise alone.
    """
    threshold = -np.log(FALSE_HARMONIC / harmonics.size)
    keep = np.abs(harmonics) ** 2 > threshold * variance
    keep[0] = True
    return np.where(keep, harmonics, 0.0)


def evaluate(
    harmonics: Complex[np.ndarray, "*loop harmonic"],
    phase: Samples,
    *,
    derivative: int = 0,
    omega: Float[np.ndarray, "*loop"] | float = 1.0,
) -> Float[np.ndarray, "*loop n"]:
    """Sum harmonics at given phases, or their time derivative.

    d^p x/dt^p = Σ Im((i n ω)^p h_n e^{i n φ}).

    Args:
        harmonics: […, n] complex.
        phase: [m] rad.
        derivative: p; 0, 1 (velocity), 2 (acceleration).
        omega: […] rad/s.
    """
    n = np.arange(1, harmonics.shape[-1] + 1)
    factor = (1j * n * np.asarray(omega)[..., None]) ** derivative
    return ((factor * harmonics) @ np.exp(1j * n[:, None] * phase)).imag
