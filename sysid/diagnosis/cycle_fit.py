r"""How probable a change of the force from cycle to cycle is, and how large it is.

Each cycle's force minus the mean over the cycles of its test consists of noise, whose size is that
of the test and whose spectrum is common to all; of errors of gain and zero that differ from cycle
to cycle, white and as a straight trend over the test, of random sign from test to test (a cell that
drifts); and of what an effect adds, of known shape and unknown size.

Gain acts along the mean loop and zero along harmonic 0.  In the basis (trend, other cycles) ×
(mean loop, zero, other shapes) the covariance is diagonal, so that no matrix is ever inverted.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize_scalar

from sysid.diagnosis.cycle_evidence import CycleEvidence, Cycles, PerTest

FAINTEST: Final = 1e-3
"""Smallest variance of a harmonic, in parts of the median: rounding otherwise."""
PASSES: Final = 5
"""Rounds of size, noise and drifts in turn."""


@dataclass(frozen=True)
class Scatter:
    """Sizes of what changes by chance.

    Attributes:
        noise: [T] N, of a coefficient of one cycle.
        spectrum: [m] variance of each coefficient, in parts of that of the test's noise; mean 1.
        gain: Standard deviations of gain errors, white over cycles and of the trend.
        zero: N, of zero errors, likewise.
    """

    noise: PerTest
    spectrum: Float[np.ndarray, " m"]
    gain: tuple[float, float] = (0.0, 0.0)
    zero: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Fitted:
    """Evidence with a change of known shape taken out.

    Attributes:
        size: Of the shape; 0 where there is none.
        scatter: What is left.
        likelihood: Log-likelihood, up to a constant of the evidence.
        along: [T] xᵀΣ⁻¹y of each test.
        square: [T] xᵀΣ⁻¹x.
    """

    size: float
    scatter: Scatter
    likelihood: float
    along: PerTest
    square: PerTest


def fit_change(
    evidence: CycleEvidence,
    change: Cycles | None = None,
    *,
    signed: bool = False,
    start: Scatter | None = None,
) -> Fitted:
    """Size of a change and of everything by chance beside it, by maximum likelihood.

    Args:
        evidence: The cycles.
        change: [T, C, m] N per unit of size, centred; none if not given.
        signed: The size may not be negative.
        start: Where to begin; white noise if not given.
    """
    none = np.zeros_like(evidence.change)
    x = none if change is None else change
    size, scatter = 0.0, start or _white(evidence)
    along = square = np.zeros(evidence.tests.size)
    for _ in range(PASSES):
        if change is not None:
            along = inner(evidence, scatter, x, evidence.change)
            square = inner(evidence, scatter, x, x)
            size = float(along.sum() / max(square.sum(), 1e-300))
            size = max(size, 0.0) if signed else size
        scatter = _scatter_of(evidence, evidence.change - size * x, scatter)
    if change is not None:
        along = inner(evidence, scatter, x, evidence.change)
        square = inner(evidence, scatter, x, x)
    left = evidence.change - size * x
    cost = inner(evidence, scatter, left, left).sum() + log_determinant(evidence, scatter)
    return Fitted(size, scatter, -0.5 * float(cost), along, square)


def inner(evidence: CycleEvidence, scatter: Scatter, one: Cycles, other: Cycles) -> PerTest:
    """oneᵀ Σ⁻¹ other of each test, [T]."""
    a, b = _split(evidence, scatter, one), _split(evidence, scatter, other)
    whole = np.sum(a.white * b.white, axis=(1, 2))
    for kind, sizes in _drifts(evidence, scatter):
        u, v = a.drift[kind], b.drift[kind]
        ut, vt = (np.sum(z * evidence.trend, axis=1) for z in (u, v))
        rest = np.sum(u * v, axis=1) - ut * vt
        white, trend = sizes
        whole = whole - rest * white / (1.0 + white) - ut * vt * trend / (1.0 + trend)
    return whole


@dataclass(frozen=True)
class _Split:
    """Whitened signals, and their components along gain and zero, [T, C] each."""

    white: Cycles
    drift: dict[str, Float[np.ndarray, "test cycle"]]


def _split(evidence: CycleEvidence, scatter: Scatter, signal: Cycles) -> _Split:
    unit = scatter.noise[:, None] * np.sqrt(scatter.spectrum)
    white = signal / unit[:, None, :]
    loop = evidence.shape / unit
    loop = loop / np.maximum(np.linalg.norm(loop, axis=1, keepdims=True), 1e-300)
    return _Split(white, {"gain": np.einsum("tcm,tm->tc", white, loop), "zero": white[:, :, 0]})


def _drifts(
    evidence: CycleEvidence, scatter: Scatter
) -> tuple[tuple[str, tuple[PerTest, PerTest]], ...]:
    """Variances of gain and zero in units of the noise: of other cycles, and of the trend."""
    per_gain, per_zero = _strength(evidence, scatter)
    return tuple(
        (kind, (white**2 * strength, (white**2 + trend**2) * strength))
        for kind, strength, (white, trend) in (
            ("gain", per_gain, scatter.gain),
            ("zero", per_zero, scatter.zero),
        )
    )


def _strength(evidence: CycleEvidence, scatter: Scatter) -> tuple[PerTest, PerTest]:
    """Squared length of the mean loop and of a zero of 1 N, in units of the noise."""
    variance = scatter.noise[:, None] ** 2 * scatter.spectrum
    return np.sum(evidence.shape**2 / variance, axis=1), 1.0 / variance[:, 0]


def log_determinant(evidence: CycleEvidence, scatter: Scatter) -> float:
    """Ln |Σ| over all tests, each of one cycle less than it has: their mean is taken out."""
    free = evidence.counts - 1.0
    m = scatter.spectrum.size
    whole = float(np.sum(free * (2.0 * m * np.log(scatter.noise) + np.log(scatter.spectrum).sum())))
    for _, (white, trend) in _drifts(evidence, scatter):
        whole += float(np.sum((free - 1.0) * np.log1p(white) + np.log1p(trend)))
    return whole


def _white(evidence: CycleEvidence) -> Scatter:
    m = evidence.shape.shape[1]
    energy = np.sum(evidence.change**2, axis=(1, 2)) / ((evidence.counts - 1) * m)
    return Scatter(np.maximum(np.sqrt(energy), evidence.least), np.ones(m))


def _scatter_of(evidence: CycleEvidence, left: Cycles, before: Scatter) -> Scatter:
    """Noise, spectrum and drifts of what is left."""
    split = _split(evidence, before, left)
    free = (evidence.counts - 1.0) * (before.spectrum.size - 2)
    energy = np.sum(split.white**2, axis=(1, 2))
    energy = energy - sum(np.sum(z**2, axis=1) for z in split.drift.values())
    noise = before.noise * np.sqrt(np.maximum(energy, 0.0) / free)
    noise = np.maximum(noise, evidence.least)
    scatter = replace(before, noise=noise, spectrum=_spectrum(evidence, left, noise))
    per_gain, per_zero = _strength(evidence, scatter)
    split = _split(evidence, scatter, left)
    return replace(
        scatter,
        gain=_drift(evidence, split.drift["gain"], per_gain),
        zero=_drift(evidence, split.drift["zero"], per_zero),
    )


def _spectrum(evidence: CycleEvidence, left: Cycles, noise: PerTest) -> Float[np.ndarray, " m"]:
    """Variance of the harmonics, mean 1; what lies along the mean loop is a gain error, no noise.

    Harmonic 0 gets that of the first: zero errors account for its slow part.
    """
    length = np.linalg.norm(evidence.shape, axis=1, keepdims=True)
    unit = evidence.shape / np.maximum(length, 1e-300)
    beside = left - np.einsum("tcm,tm->tc", left, unit)[:, :, None] * unit[:, None, :]
    energy = np.sum((beside / noise[:, None, None]) ** 2, axis=(0, 1))
    degrees = (evidence.counts - 1.0) @ (1.0 - unit**2)
    variance = energy[1:].reshape(-1, 2).sum(axis=1) / degrees[1:].reshape(-1, 2).sum(axis=1)
    variance = np.maximum(variance, FAINTEST * np.median(variance))
    each = np.concatenate([variance[:1], np.repeat(variance, 2)])
    return each / each.mean()


def _drift(
    evidence: CycleEvidence, found: Float[np.ndarray, "test cycle"], strength: PerTest
) -> tuple[float, float]:
    """Standard deviations, white and of the trend, that make the components most probable."""
    trend = np.sum(found * evidence.trend, axis=1) ** 2
    rest = np.maximum(np.sum(found**2, axis=1) - trend, 0.0)
    degrees = evidence.counts - 2.0
    white = _most_probable(
        lambda v: float(np.sum(degrees * np.log1p(v * strength) + rest / (1.0 + v * strength))),
        float(np.sum(rest) / np.sum(degrees * strength)),
    )
    both = _most_probable(
        lambda v: float(
            np.sum(np.log1p((white + v) * strength) + trend / (1.0 + (white + v) * strength))
        ),
        float(np.sum(trend) / np.sum(strength)),
    )
    return float(np.sqrt(white)), float(np.sqrt(both))


def _most_probable(cost: Callable[[float], float], typical: float) -> float:
    """Variance of the least cost, from 0 to a thousand times a typical one."""
    if not typical > 0.0:
        return 0.0
    ends = (np.log(1e-6 * typical), np.log(1e3 * typical))
    found = minimize_scalar(lambda z: cost(float(np.exp(z))), bounds=ends, method="bounded")
    place = getattr(found, "x")  # noqa: B009 - the result's type has no stub
    best = float(np.exp(place))
    return best if cost(best) < cost(0.0) else 0.0
