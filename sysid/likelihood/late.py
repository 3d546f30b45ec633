r"""Delays of the force channel beyond their first order.

Σ has the delay τ of a test to first order: τ²ḞḞᵀ, what a late force differs by from one in time
being −τḞ.  Of a force that turns over within a millisecond the harmonics up to the fifteenth show
more than that: a test that is late by 0.3 ms seems to err in the width of its loop, by several
times its noise.  In harmonic n, with θ = nωτ,

    e^(−iθ) = 1 − iθ + (e^(−iθ) − 1 + iθ),

and what is in brackets is taken out of the measured harmonics: c ← c (1 − iθ) e^(iθ).  What is left
is as if delays acted to first order.  τ is the mean of what Σ makes of a model's residual, and is
taken about the campaign's median, since a delay of all tests is an effect of its own.  An error of
τ by δ leaves δ²/τ² of what is taken out, and the first order itself is not touched, so that no
delay has to be known well.
"""

from dataclasses import replace
from typing import Final, TypeVar

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.observed import Observed
from sysid.likelihood.reml import fit_sizes
from sysid.models.coordinates import AbstractCoordinates

Measured = TypeVar("Measured", bound=Observed)

MOST: Final = 0.3
"""rad, θ of the highest harmonic from which on no delay is believed: a model that errs by so much
errs otherwise, and its tests are left as they are."""

ROUGH: Final = 0.1
"""Log-likelihood within which sizes of Σ tell delays well enough."""


def straightened_beside(
    observed: Measured, coordinates: AbstractCoordinates, u: Float[np.ndarray, " n"]
) -> tuple[Measured, Sizes]:
    """Measured loops as if delays acted to first order, beside a fitted model.

    Σ is the one that makes its residual most probable.

    Args:
        observed: Measured loops beside a model (`Observed.beside`).
        coordinates: Map from u to the model.
        u: [n], fitted.

    Returns:
        The loops, and the sizes of Σ, within `ROUGH`.
    """
    residual, jacobian = observed.look(coordinates, u)
    found = fit_sizes(observed.parts, residual, jacobian, tolerance=ROUGH)
    return straightened(observed, found.covariance, residual), found.sizes


def straightened(
    observed: Measured, covariance: Covariance, residual: Float[np.ndarray, "loop m"]
) -> Measured:
    """Measured loops as if delays acted to first order.

    Args:
        observed: Measured loops, straightened before or not.
        covariance: Σ, of this model.
        residual: [L, m] N, what the model leaves of them.
    """
    rate = observed.parts.rate
    late = covariance.expected(residual, ("delay",))
    delay = -np.sum(late * rate, axis=1) / np.maximum(np.sum(rate**2, axis=1), 1e-300)
    delay -= np.median(delay)
    turn = 2.0 * np.pi * observed.loops.frequency * delay
    turn[np.abs(turn) * observed.basis.order.max() > MOST] = 0.0
    recorded = observed.measured + observed.bend
    straight = _straight(recorded, turn[:, None] * observed.basis.order[1::2])
    return replace(observed, measured=straight, bend=recorded - straight)


def _straight(
    c: Float[np.ndarray, "loop m"], theta: Float[np.ndarray, "loop n"]
) -> Float[np.ndarray, "loop m"]:
    """Harmonics c, N, times (1 − iθ) e^(iθ), θ in rad of harmonics 1, 2, …; c_0 as it is."""
    lines = (c[:, 1::2] - 1j * c[:, 2::2]) * (1.0 - 1j * theta) * np.exp(1j * theta)
    out = c.copy()
    out[:, 1::2], out[:, 2::2] = lines.real, -lines.imag
    return out
