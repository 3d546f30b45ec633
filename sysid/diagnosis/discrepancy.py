r"""Covariance of what a right model would still leave: noise, rig errors, imperfect laws.

In orthonormal harmonics (`compress`), loop l with m coefficients,

    Σ = ⊕_l [ σ_l² 1 + γ² F_l F_lᵀ + o² e_0 e_0ᵀ + τ² Ḟ_l Ḟ_lᵀ ] + S (K_c ⊗ K_p) S

- σ_l: noise of the cycle mean, known from cycle-to-cycle scatter;
- γ, o, τ: gain, offset and delay of the force channel that vary from test to test;
- the structural term: an error of the base model's laws is smooth over conditions
  (K_c: squared exponential in log A, log f and i), of the size of the force itself
  (S = diag of each loop's RMS force), and falls with the harmonic (K_p), odd and even harmonics
  with a size of their own.

All coefficients share K_c, so one eigendecomposition a campaign, with N = diag(σ_l²),

    N^−½ S K_c S N^−½ = U Λ Uᵀ,

makes noise and structural term diagonal whatever the sizes: 1 + s_m Λ_k in mode k, coefficient m.
What varies from test to test is three vectors a loop beside it (Woodbury).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_solve, eigh, solve_triangular

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


NAMES: Final = ("gain", "offset", "delay", "odd", "even")
"""Order of the sizes wherever derivatives with respect to them are listed."""


@dataclass(frozen=True)
class Modes:
    """What of Σ does not depend on sizes, in the modes of the structural term.

    Attributes:
        values: [L] Λ.
        turn: [L, L] N^−½ U, from modes to loops; its transpose leads back.
        rolled: [2, m] K_p for unit sizes of odd and of even harmonics.
        varying: [3, L, m] gain, offset and delay of unit size, N, N and N/s.
        groups: Columns of the coefficients of one harmonic each.
    """

    values: Float[np.ndarray, " loop"]
    turn: Float[np.ndarray, "loop loop"]
    rolled: Float[np.ndarray, "2 m"]
    varying: Float[np.ndarray, "3 loop m"]
    groups: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Parts:
    """What Σ is made of, for L loops and m coefficients each.

    Attributes:
        noise: [L] N, standard deviation of each coefficient.
        force: [L, m] N, coefficients of the force: of a model that was fitted, not the measured
            one, or a gain error of 100 % would explain every measurement.
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

    @cached_property
    def modes(self) -> Modes:
        """Modes of the structural term; found once, whatever the sizes."""
        whitened = self.scale / self.noise
        values, vectors = eigh(self.kernel * whitened[:, None] * whitened[None, :])
        odd = self.order % 2 == 1
        offset = np.zeros_like(self.force)
        offset[:, 0] = 1.0
        return Modes(
            values=np.maximum(values, 0.0),
            turn=vectors / self.noise[:, None],
            rolled=np.stack([odd, ~odd]) / (1.0 + (self.order / ROLL_OFF) ** 4),
            varying=np.stack([self.force, offset, self.rate]),
            groups=tuple(np.flatnonzero(self.order == n) for n in np.unique(self.order)),
        )

    def to_modes(self, a: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "loop m k"]:
        """Uᵀ N^−½ a: unit variance for noise, uncorrelated for the structural term."""
        return (self.modes.turn.T @ a.reshape(a.shape[0], -1)).reshape(a.shape)


@dataclass(frozen=True)
class Solved:
    """Σ⁻¹a in two views.

    Attributes:
        modal: [L, m, k], in modes.
        varying: [3, L, k], its product with the vectors of gain, offset and delay.
    """

    modal: Float[np.ndarray, "loop m k"]
    varying: Float[np.ndarray, "3 loop k"]


class Covariance:
    """Σ for given sizes: solves, determinant, square root and derivatives.

    Args:
        parts: What Σ is made of; its modes are shared by all sizes.
        sizes: Standard deviations.

    Attributes:
        log_determinant: log|Σ|.
    """

    log_determinant: float

    def __init__(self, parts: Parts, sizes: Sizes) -> None:
        modes = parts.modes
        self._parts, self._modes = parts, modes
        squared = np.array([sizes.odd, sizes.even])[:, None] ** 2
        self._structural = (squared * modes.rolled)[:, None, :] * modes.values[:, None]  # [2, L, m]
        self._variance = 1.0 + self._structural.sum(axis=0)  # [L, m]
        size = np.array([sizes.gain, sizes.offset, sizes.delay])
        self._varying = size[:, None, None] * modes.varying
        coupled = self._coupled(1.0 / self._variance)
        self._root = np.linalg.cholesky(np.eye(coupled.shape[0]) + coupled)
        self.log_determinant = float(
            np.log(self._variance).sum()
            + 2.0 * self._variance.shape[1] * np.log(parts.noise).sum()
            + 2.0 * np.log(np.diagonal(self._root)).sum()
        )

    def inner(
        self, a: Float[np.ndarray, "loop m k"], b: Float[np.ndarray, "loop m q"]
    ) -> Float[np.ndarray, "k q"]:
        """aᵀ Σ⁻¹ b."""
        left = self._reduced(a)
        right = left if b is a else self._reduced(b)
        return left[0].T @ right[0] - left[1].T @ right[1]

    def whiten(self, a: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "loop*m k"]:
        """Square root of Σ⁻¹: products of what it returns are those of `inner`.

        Wᵀ W = Σ⁻¹; with D noise and structural term, V what varies and LLᵀ = 1 + VᵀD⁻¹V,
        W = (1 − D^−½V (1 + Lᵀ)⁻¹ L⁻¹ VᵀD^−½) D^−½.
        """
        plain, z = self._reduced(a)
        sheared = np.eye(z.shape[0]) + self._root
        z = solve_triangular(sheared, z, lower=True, trans=1, check_finite=False)
        spread = self._spread(z.reshape(*self._varying.shape[:2], -1))
        return plain - (spread / np.sqrt(self._variance)[:, :, None]).reshape(plain.shape)

    def solve(self, modal: Float[np.ndarray, "loop m k"]) -> Solved:
        """Σ⁻¹a of a given in modes (`Parts.to_modes`)."""
        first = modal / self._variance[:, :, None]
        z = self._gathered(first)
        z = cho_solve((self._root, True), z, check_finite=False)
        z = z.reshape(*self._varying.shape[:2], -1)
        return Solved(first - self._spread(z) / self._variance[:, :, None], z)

    def slopes_of_log_determinant(self) -> Float[np.ndarray, " 5"]:
        """∂ log|Σ| / ∂ ln size, in the order of `NAMES`."""
        inverse = cho_solve((self._root, True), np.eye(self._root.shape[0]), check_finite=False)
        own = 1.0 - np.diagonal(inverse).reshape(3, -1)
        both = [
            np.sum(part / self._variance)
            - np.sum(inverse * self._coupled(part / self._variance**2))
            for part in self._structural
        ]
        return 2.0 * np.concatenate([own.sum(axis=1), both])

    def slopes_of_inner(self, solved: Solved) -> Float[np.ndarray, "5 k"]:
        """xᵀ (∂Σ/∂ ln size) x for each column x = Σ⁻¹a, in the order of `NAMES`."""
        varying = np.sum(solved.varying**2, axis=1)
        structural = np.einsum("slm,lmk->sk", self._structural, solved.modal**2)
        return 2.0 * np.concatenate([varying, structural])

    def changes(self, solved: Solved) -> Float[np.ndarray, "loop m 5"]:
        """(∂Σ/∂ ln size) x in modes, of one column x = Σ⁻¹a, in the order of `NAMES`."""
        alone = np.zeros((*self._varying.shape[:2], 3))
        for kind in range(3):
            alone[kind, :, kind] = solved.varying[kind, :, 0]
        structural = np.moveaxis(self._structural, 0, 2) * solved.modal
        return 2.0 * np.concatenate([self._spread(alone), structural], axis=2)

    def _reduced(
        self, a: Float[np.ndarray, "loop m k"]
    ) -> tuple[Float[np.ndarray, "loop*m k"], Float[np.ndarray, "3*loop k"]]:
        """D^−½ a in modes, and L⁻¹ VᵀD⁻¹a."""
        root = np.sqrt(self._variance)[:, :, None]
        plain = self._parts.to_modes(a) / root
        z = self._gathered(plain / root)
        z = solve_triangular(self._root, z, lower=True, check_finite=False)
        return plain.reshape(-1, a.shape[2]), z

    def _gathered(self, modal: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "3*loop k"]:
        """Vᵀ of what is given in modes."""
        count, m, k = modal.shape
        at_loops = (self._modes.turn @ modal.reshape(count, -1)).reshape(count, m, k)
        return np.moveaxis(np.moveaxis(self._varying, 0, 1) @ at_loops, 1, 0).reshape(-1, k)

    def _spread(self, z: Float[np.ndarray, "3 loop k"]) -> Float[np.ndarray, "loop m k"]:
        """V z in modes."""
        at_loops = np.transpose(self._varying, (1, 2, 0)) @ np.moveaxis(z, 0, 1)
        return self._parts.to_modes(at_loops)

    def _coupled(self, weight: Float[np.ndarray, "loop m"]) -> Float[np.ndarray, "3*loop 3*loop"]:
        """Vᵀ diag(weight) V, weight in modes and alike for the coefficients of one harmonic."""
        kinds, count, _ = self._varying.shape
        total = np.zeros((kinds, count, kinds, count))
        turn = self._modes.turn
        for group in self._modes.groups:
            if not weight[:, group[0]].any():
                continue
            middle = (turn * weight[:, group[0]]) @ turn.T
            part = self._varying[:, :, group]
            present = [kind for kind in range(kinds) if part[kind].any()]
            for place, one in enumerate(present):
                for other in present[place:]:
                    total[one, :, other] += (part[one] @ part[other].T) * middle
        for one in range(kinds):
            for other in range(one):
                total[one, :, other] = total[other, :, one].T
        return total.reshape(kinds * count, -1)


def covariance_parts(
    loops: Loops, basis: HarmonicBasis, simulated: Float[np.ndarray, "loop m"] | None = None
) -> Parts:
    """Read the parts of Σ off the loops.

    The noise of a coefficient is the RMS, over cycles and coefficients, of the cycles' own
    coefficients about their mean, over √C; with a single cycle the median of the other tests.

    Args:
        loops: L tests.
        basis: Harmonics.
        simulated: [L, m] N, of a fitted model; the measured force if there is none yet.
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
    force = basis.compress(loops.force) if simulated is None else simulated
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
