r"""Covariance of what a right model would still leave: noise, rig errors, imperfect laws.

In orthonormal harmonics (`compress`), loop l with m coefficients,

    Σ = ⊕_l [ σ_l² 1 + γ² F_l F_lᵀ + o² e_0 e_0ᵀ + τ² Ḟ_l Ḟ_lᵀ ] + S (K_c ⊗ K_p) S

- σ_l: noise of the cycle mean, known from cycle-to-cycle scatter;
- γ, o, τ: gain, offset and delay of the force channel that vary from test to test;
- the structural term: an error of the base model's laws is smooth over conditions
  (K_c: squared exponential in log A, log f and i), of the size of the force itself
  (S = diag of each loop's RMS force), and falls with the harmonic (K_p), odd and even harmonics
  with a size of their own.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_factor, cho_solve

from sysid.data.loops import Loops
from sysid.diagnosis.compress import HarmonicBasis

LENGTHS: Final = (1.2, 1.2, 0.5)
"""Correlation lengths of the laws in ln A, ln f and i/i_max."""
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
    """Σ in a form that solves fast: built once for given sizes, used for many right-hand sides.

    Noise and structural term couple loops but not harmonics: one L × L matrix a coefficient.  What
    varies from test to test couples the harmonics of a loop but not loops: three vectors a loop,
    whose capacity matrix is factored (Woodbury).
    """

    log_determinant: float

    def __init__(self, parts: "Parts", sizes: Sizes) -> None:
        smooth = _structural(parts, sizes)  # [m, L, L]
        roots = np.linalg.cholesky(smooth)
        self._inverse = np.linalg.inv(smooth)
        self._varying = _varying(parts, sizes)  # [L, m, 3]
        loops, _, kinds = self._varying.shape
        coupled = np.einsum(
            "lma,mlk,kmb->lakb", self._varying, self._inverse, self._varying, optimize=True
        )
        capacity = np.eye(kinds * loops) + coupled.reshape(kinds * loops, kinds * loops)
        self._capacity = cho_factor(capacity, lower=True)
        self.log_determinant = float(
            2.0 * np.log(np.einsum("mll->ml", roots)).sum()
            + 2.0 * np.log(np.diagonal(self._capacity[0])).sum()
        )

    def inner(
        self, a: Float[np.ndarray, "loop m k"], b: Float[np.ndarray, "loop m q"]
    ) -> Float[np.ndarray, "k q"]:
        """aᵀ Σ⁻¹ b."""
        solved = np.einsum("mlk,kmq->lmq", self._inverse, b, optimize=True)
        left = np.einsum("lmk,lmq->kq", a, solved, optimize=True)
        z = np.einsum("lma,lmq->laq", self._varying, solved).reshape(-1, b.shape[2])
        other = np.einsum("mlk,kmq->lmq", self._inverse, a, optimize=True)
        y = np.einsum("lma,lmq->laq", self._varying, other).reshape(-1, a.shape[2])
        return left - y.T @ cho_solve(self._capacity, z)


@dataclass(frozen=True)
class Parts:
    """What Σ is made of, for L loops and m coefficients each.

    Attributes:
        noise: [L] N, standard deviation of each coefficient.
        force: [L, m] N, coefficients of the measured force.
        rate: [L, m] N/s, of its time derivative.
        scale: [L] N, RMS force.
        order: [m] harmonic of each coefficient.
        kernel: [L, L], K_c.
    """

    noise: Float[np.ndarray, " loop"]
    force: Float[np.ndarray, "loop m"]
    rate: Float[np.ndarray, "loop m"]
    scale: Float[np.ndarray, " loop"]
    order: np.ndarray
    kernel: Float[np.ndarray, "loop loop"]


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
        kernel=_kernel(loops),
    )


def _derivative(c: Float[np.ndarray, "loop m"], basis: HarmonicBasis) -> np.ndarray:
    """Coefficients of dF/dφ: cos nφ → −n sin nφ, sin nφ → n cos nφ."""
    out = np.zeros_like(c)
    n = basis.order[1::2]
    out[:, 1::2] = n * c[:, 2::2]
    out[:, 2::2] = -n * c[:, 1::2]
    return out


def _kernel(loops: Loops) -> Float[np.ndarray, "loop loop"]:
    """K_c over (ln A, ln f, i/i_max)."""
    largest = float(np.abs(loops.current).max()) or 1.0
    place = np.stack(
        [np.log(loops.amplitude), np.log(loops.frequency), loops.current / largest], axis=1
    )
    apart = (place[:, None, :] - place[None, :, :]) / np.array(LENGTHS)
    return np.exp(-0.5 * np.sum(apart**2, axis=2))


def _varying(parts: Parts, sizes: Sizes) -> Float[np.ndarray, "loop m 3"]:
    """What varies from test to test: gain, offset and delay, one vector each."""
    offset = np.zeros_like(parts.force)
    offset[:, 0] = sizes.offset
    return np.stack([sizes.gain * parts.force, offset, sizes.delay * parts.rate], axis=2)


def _structural(parts: Parts, sizes: Sizes) -> Float[np.ndarray, "m loop loop"]:
    """Noise and structural term, one matrix over loops for each coefficient."""
    size = np.where(parts.order % 2 == 1, sizes.odd, sizes.even) ** 2
    size = size / (1.0 + (parts.order / ROLL_OFF) ** 4)
    shape = parts.kernel * parts.scale[:, None] * parts.scale[None, :]
    return size[:, None, None] * shape + np.diag(parts.noise**2)
