r"""Covariance of what a right model would still leave: noise, rig errors, imperfect laws.

In orthonormal harmonics (`compress`), loop l with m coefficients,

    Σ = ⊕_l [ σ_l² 1 + γ² F_l F_lᵀ + o² e_0 e_0ᵀ + τ² Ḟ_l Ḟ_lᵀ ] + S (K_c ⊗ K_p) S

- σ_l: noise of the cycle mean, known from cycle-to-cycle scatter;
- γ, o, τ: gain, offset and delay of the force channel that vary from test to test;
- the structural term: an error of the base model's laws is smooth over conditions
  (K_c: squared exponential in log A, log f and i), of the size of the force itself
  (S = diag of each loop's RMS force), and falls with the harmonic (K_p), odd and even harmonics
  with a size of their own.

K_c is kept to its leading eigenvectors, so that every solve costs a small matrix only.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from sysid.data.loops import Loops
from sysid.diagnosis.compress import HarmonicBasis

LENGTHS: Final = (1.2, 1.2, 0.5)
"""Correlation lengths of the laws in ln A, ln f and i/i_max."""
KEPT: Final = 1e-3
"""Eigenvalues of K_c below this part of the largest are dropped."""
ROLL_OFF: Final = 3.0
"""Harmonic at which the structural error has fallen to half."""


@dataclass(frozen=True)
class Sizes:
    """Standard deviations of the parts of Σ.

    Attributes:
        gain: Relative, from test to test.
        offset: N.
        delay: s.
        odd: Structural error in odd harmonics, parts of the RMS force.
        even: In even harmonics (and the mean).
    """

    gain: float = 0.01
    offset: float = 3.0
    delay: float = 2e-4
    odd: float = 0.0
    even: float = 0.0


class Covariance:
    """Σ in a form that whitens: built once for given sizes, used for many right-hand sides.

    Blocks of single loops are Cholesky-factored; the structural term is a low-rank update whose
    capacity matrix is factored (Woodbury).
    """

    log_determinant: float

    def __init__(self, parts: "Parts", sizes: Sizes) -> None:
        self._blocks = np.linalg.cholesky(_blocks(parts, sizes))
        self._update = _structural(parts, sizes)
        half = self._half(self._update)
        rank = half.shape[-1]
        flat = half.reshape(-1, rank)
        self._capacity = cho_factor(np.eye(rank) + flat.T @ flat, lower=True)
        self._flat = flat
        diagonal = np.log(np.einsum("lmm->lm", self._blocks)).sum()
        self.log_determinant = float(
            2.0 * diagonal + 2.0 * np.log(np.diagonal(self._capacity[0])).sum()
        )

    def _half(self, z: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "loop m k"]:
        """L⁻¹ z for each loop's block L Lᵀ."""
        return np.stack(
            [solve_triangular(c, b, lower=True) for c, b in zip(self._blocks, z, strict=True)]
        )

    def inner(
        self, a: Float[np.ndarray, "loop m k"], b: Float[np.ndarray, "loop m q"]
    ) -> Float[np.ndarray, "k q"]:
        """aᵀ Σ⁻¹ b."""
        left, right = (self._half(z).reshape(-1, z.shape[-1]) for z in (a, b))
        correction = cho_solve(self._capacity, self._flat.T @ right)
        return left.T @ right - (self._flat.T @ left).T @ correction


@dataclass(frozen=True)
class Parts:
    """What Σ is made of, for L loops and m coefficients each.

    Attributes:
        noise: [L] N, standard deviation of each coefficient.
        force: [L, m] N, coefficients of the measured force.
        rate: [L, m] N/s, of its time derivative.
        scale: [L] N, RMS force.
        order: [m] harmonic of each coefficient.
        smooth: [L, r], K_c ≈ smooth smoothᵀ.
    """

    noise: Float[np.ndarray, " loop"]
    force: Float[np.ndarray, "loop m"]
    rate: Float[np.ndarray, "loop m"]
    scale: Float[np.ndarray, " loop"]
    order: np.ndarray
    smooth: Float[np.ndarray, "loop r"]


def covariance_parts(loops: Loops, basis: HarmonicBasis) -> Parts:
    """Read the parts of Σ off the loops.

    The noise of a coefficient is the RMS, over cycles and coefficients, of the cycles' own
    coefficients about their mean, over √C; with a single cycle the median of the other tests.
    """
    noise = np.full(len(loops.ids), np.nan)
    for k, deviations in enumerate(loops.deviations):
        cycles = deviations.shape[0]
        if cycles > 1:
            c = basis.compress(deviations)
            noise[k] = np.sqrt(np.sum(c**2) / (cycles - 1) / cycles / basis.order.size)
    scale = np.sqrt(np.mean(loops.force**2, axis=1))
    typical = np.nanmedian(noise / scale) if np.isfinite(noise).any() else 1e-3
    noise = np.where(np.isfinite(noise), noise, typical * scale)
    force = basis.compress(loops.force)
    return Parts(
        noise=np.maximum(noise, 1e-5 * scale),
        force=force,
        rate=2.0 * np.pi * loops.frequency[:, None] * _derivative(force, basis),
        scale=scale,
        order=basis.order,
        smooth=_smooth(loops),
    )


def _derivative(c: Float[np.ndarray, "loop m"], basis: HarmonicBasis) -> np.ndarray:
    """Coefficients of dF/dφ: cos nφ → −n sin nφ, sin nφ → n cos nφ."""
    out = np.zeros_like(c)
    n = basis.order[1::2]
    out[:, 1::2] = n * c[:, 2::2]
    out[:, 2::2] = -n * c[:, 1::2]
    return out


def _smooth(loops: Loops) -> Float[np.ndarray, "loop r"]:
    """Square root of K_c over (ln A, ln f, i/i_max), leading eigenvectors only."""
    largest = float(np.abs(loops.current).max()) or 1.0
    place = np.stack(
        [np.log(loops.amplitude), np.log(loops.frequency), loops.current / largest], axis=1
    )
    apart = (place[:, None, :] - place[None, :, :]) / np.array(LENGTHS)
    value, vector = np.linalg.eigh(np.exp(-0.5 * np.sum(apart**2, axis=2)))
    kept = value > KEPT * value[-1]
    return vector[:, kept] * np.sqrt(value[kept])


def _blocks(parts: Parts, sizes: Sizes) -> Float[np.ndarray, "loop m m"]:
    """Covariance of each loop alone."""
    m = parts.order.size
    blocks = (parts.noise**2)[:, None, None] * np.eye(m)
    blocks = blocks + sizes.gain**2 * parts.force[:, :, None] * parts.force[:, None, :]
    blocks += sizes.delay**2 * parts.rate[:, :, None] * parts.rate[:, None, :]
    blocks[:, 0, 0] += sizes.offset**2
    return blocks


def _structural(parts: Parts, sizes: Sizes) -> Float[np.ndarray, "loop m k"]:
    """Factor U of the structural term U Uᵀ, k = r·m."""
    size = np.where(parts.order % 2 == 1, sizes.odd, sizes.even)
    size = size / np.sqrt(1.0 + (parts.order / ROLL_OFF) ** 4)
    used = size > 0.0
    if not used.any():
        return np.zeros((parts.scale.size, parts.order.size, 1))
    columns = np.eye(parts.order.size)[:, used] * size[used]
    left = parts.scale[:, None] * parts.smooth
    return np.einsum("lr,mk->lmrk", left, columns).reshape(left.shape[0], parts.order.size, -1)
