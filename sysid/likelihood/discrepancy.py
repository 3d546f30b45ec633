r"""Covariance of what a right model would still leave: noise, rig errors, imperfect laws.

In orthonormal harmonics (`compress`), loop l with m coefficients,

    Σ = ⊕_l [ σ_l² 1 + γ² F_l F_lᵀ + o² e_0 e_0ᵀ + τ² Ḟ_l Ḟ_lᵀ ] + S (K_c ⊗ K_p) S
        + Σ_p s_p² Δ_p K_c Δ_pᵀ

- σ_l: noise of the cycle mean, known from cycle-to-cycle scatter;
- γ, o, τ: gain, offset and delay of the force channel that vary from test to test; where the
  valve's force goes by temperature, so does the error ϑ of the thermometer about its oil,
  ϑ² F'_l F'_lᵀ with F' = ∂F/∂T (`Parts.warmth`);
- the structural term: an error of the base model's laws is smooth over conditions
  (K_c, `kernel`: squared exponential in log A, log f, i and T), of the size of the force
  (S = diag of each loop's RMS force), and falls with the harmonic (K_p), odd and even harmonics
  with a size of their own;
- s_p: relative errors of the valve's laws (scale of the force, width of its hysteresis,
  steepness of its step, growth of the force with speed), smooth over conditions too.
  Δ_p = ⊕_l d_pl, d_pl the change of loop l's force for a relative change of law p by one
  (`Parts.laws`; without them this term is absent).
  Without it a smooth error of scale passes for gain γ, independent from test to test, and smooth
  effects are tested against too small an error.

All coefficients share K_c, so one eigendecomposition a campaign, with N = diag(σ_l²),

    N^−½ S K_c S N^−½ = U Λ Uᵀ,

makes noise and structural term diagonal whatever the sizes: 1 + s_m Λ_k in mode k, coefficient m.
What varies from test to test is a few vectors a loop beside it, and a law is Δ_p R, RRᵀ = K_c
(Woodbury): V = [F, e_0, Ḟ, F', Δ_p R].  All but R are one vector a loop each, so products with them
are taken loop by loop, and R acts on what comes out.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_solve, solve_triangular
from scipy.linalg.lapack import dpotri  # pyright: ignore[reportAttributeAccessIssue]

from sysid.likelihood.discrepancy_parts import (
    LAWS,
    RIG,
    ROLL_OFF,
    Modes,
    Parts,
    covariance_parts,
)

__all__ = [
    "LAWS",
    "NAMES",
    "RIG",
    "ROLL_OFF",
    "Covariance",
    "Modes",
    "Parts",
    "Sizes",
    "Solved",
    "covariance_parts",
]


PORTION: Final = 32
"""Loops whose part of VᵀD⁻¹V is found together, in few steps: threads wait for each short one."""


@dataclass(frozen=True)
class Sizes:
    """Standard deviations of the parts of Σ.

    Attributes:
        gain: Relative, from test to test.
        offset: N.
        delay: s.
        odd: Structural error in odd harmonics, parts of the RMS force.
        even: In even harmonics (and the mean).
        scale: Smooth relative error of the scale of the valve's force.
        width: Of the width of its hysteresis.
        steepness: Of the steepness of its step.
        growth: Of the growth of the force with speed beyond the step.
        thermometer: Error of the recorded temperature about the oil, from test to test, K.
    """

    gain: float = 0.01
    offset: float = 3.0
    delay: float = 2e-4
    odd: float = 0.0
    even: float = 0.0
    scale: float = 0.0
    width: float = 0.0
    steepness: float = 0.0
    growth: float = 0.0
    thermometer: float = 0.0


NAMES: Final = (*RIG, "odd", "even", *LAWS)
"""Order of the sizes wherever derivatives with respect to them are listed."""


@dataclass(frozen=True)
class Solved:
    """Σ⁻¹a in two views.

    Attributes:
        modal: [L, m, k], in modes.
        columns: [c, k], its product with the columns of V; those of parts of Σ whose size is zero
            are not there.
    """

    modal: Float[np.ndarray, "loop m k"]
    columns: Float[np.ndarray, "c k"]


class Covariance:
    """Σ for given sizes: solves, determinant, square root and derivatives.

    Args:
        parts: What Σ is made of; its modes are shared by all sizes.
        sizes: Standard deviations.

    Attributes:
        sizes: The same.
        log_determinant: log|Σ|.
    """

    sizes: Sizes
    log_determinant: float

    def __init__(self, parts: Parts, sizes: Sizes) -> None:
        modes = parts.modes
        self.sizes, self._parts, self._modes = sizes, parts, modes
        squared = np.array([sizes.odd, sizes.even])[:, None] ** 2
        self._structural = (squared * modes.rolled)[:, None, :] * modes.values[:, None]  # [2, L, m]
        self._variance = 1.0 + self._structural.sum(axis=0)  # [L, m]
        kinds = (*parts.rig, *LAWS[: len(parts.laws)])
        size = np.array([getattr(sizes, name) for name in kinds])
        varying = size[:, None, None] * modes.varying  # [t + P, L, m], kept below, twice
        there = np.flatnonzero(varying.any(axis=(1, 2)))
        there = there if there.size else np.array([0])  # what is absent has no columns in V
        varying = varying[there]
        self._places = [NAMES.index(kinds[kind]) for kind in there]
        self._at_loops = np.ascontiguousarray(np.moveaxis(varying, 0, 1))  # [L, kind, m]
        self._across = np.ascontiguousarray(np.swapaxes(varying, 1, 2))  # [kind, m, L]
        heard = varying.any(axis=1) * np.arange(1, varying.shape[2] + 1)
        self._reach = heard.max(axis=1).tolist()  # coefficients of each kind, but for zeros behind
        count, rank = modes.smooth.shape
        self._of_rig = int(np.sum(there < len(parts.rig)))  # kinds
        self._alone = self._of_rig * count  # columns of V that belong to one loop each
        widths = [count] * self._of_rig + [rank] * (there.size - self._of_rig)
        ends = np.cumsum(widths)
        self._starts = ends - widths  # first column of V of each kind
        self._columns = [slice(*ends) for ends in zip(self._starts, ends, strict=True)]
        coupled = self._coupled(1.0 / self._variance)
        np.fill_diagonal(coupled, 1.0 + np.diagonal(coupled))
        self._root = np.linalg.cholesky(coupled)
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

    def squares(
        self, a: Float[np.ndarray, "loop m k"], b: Float[np.ndarray, "loop m q"]
    ) -> tuple[Float[np.ndarray, " k"], Float[np.ndarray, "q k"]]:
        """Diagonal of aᵀΣ⁻¹a, and bᵀΣ⁻¹a: for many columns, whose products nobody needs."""
        left, right = self._reduced(a), self._reduced(b)
        own = np.sum(left[0] ** 2, axis=0) - np.sum(left[1] ** 2, axis=0)
        return own, right[0].T @ left[0] - right[1].T @ left[1]

    def whiten(self, a: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "loop*m k"]:
        """Square root of Σ⁻¹: products of what it returns are those of `inner`.

        Wᵀ W = Σ⁻¹; with D noise and structural term, V the columns beside them and
        LLᵀ = 1 + VᵀD⁻¹V, W = (1 − D^−½V (1 + Lᵀ)⁻¹ L⁻¹ VᵀD^−½) D^−½.
        """
        plain, z = self._reduced(a)
        sheared = np.eye(z.shape[0]) + self._root
        z = solve_triangular(sheared, z, lower=True, trans=1, check_finite=False)
        spread = self._spread(z)
        return plain - (spread / np.sqrt(self._variance)[:, :, None]).reshape(plain.shape)

    def weighted(self, a: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "loop m k"]:
        """Σ⁻¹a."""
        solved = self.solve(self._parts.to_modes(a)).modal
        return (self._modes.turn @ solved.reshape(a.shape[0], -1)).reshape(a.shape)

    def solve(self, modal: Float[np.ndarray, "loop m k"]) -> Solved:
        """Σ⁻¹a of a given in modes (`Parts.to_modes`)."""
        first = modal / self._variance[:, :, None]
        z = cho_solve((self._root.T, False), self._gathered(first), check_finite=False)
        return Solved(first - self._spread(z) / self._variance[:, :, None], z)

    def slopes_of_log_determinant(self) -> Float[np.ndarray, " name"]:
        """∂ log|Σ| / ∂ ln size, in the order of `NAMES`."""
        inverse = dpotri(self._root.T, lower=0)[0].T  # below its diagonal, half the work of all
        diagonal = np.diagonal(inverse).copy()
        own = np.add.reduceat(1.0 - diagonal, self._starts)
        inverse *= 2.0
        np.fill_diagonal(inverse, diagonal)
        first = self._modes.first
        by_weight = self._traced(inverse) / self._variance[:, first] ** 2
        both = [
            np.sum(part / self._variance) - np.sum(by_weight * part[:, first])
            for part in self._structural
        ]
        return 2.0 * self._ordered(own, np.array(both))

    def slopes_of_inner(self, solved: Solved) -> Float[np.ndarray, "name k"]:
        """xᵀ (∂Σ/∂ ln size) x for each column x = Σ⁻¹a, in the order of `NAMES`."""
        own = np.add.reduceat(solved.columns**2, self._starts, axis=0)
        structural = np.einsum("slm,lmk->sk", self._structural, solved.modal**2)
        return 2.0 * self._ordered(own, structural)

    def changes(self, solved: Solved) -> Float[np.ndarray, "loop m name"]:
        """(∂Σ/∂ ln size) x in modes, of one column x = Σ⁻¹a, in the order of `NAMES`."""
        kinds = self._starts.size
        alone = np.zeros((solved.columns.shape[0], kinds))
        bounds = [*self._starts, alone.shape[0]]
        for kind in range(kinds):
            own = slice(bounds[kind], bounds[kind + 1])
            alone[own, kind] = solved.columns[own, 0]
        varying = np.moveaxis(self._spread(alone), 2, 0)
        structural = self._structural * solved.modal[:, :, 0]
        return 2.0 * np.moveaxis(self._ordered(varying, structural), 0, 2)

    def expected(
        self, residual: Float[np.ndarray, "loop m"], names: tuple[str, ...]
    ) -> Float[np.ndarray, "loop m"]:
        """Mean of some parts of the error, all parts together having left the residual.

        E[Σ_k e_k | r] = Σ_k Σ⁻¹ r, summed over the named parts k.

        Args:
            residual: [L, m] N.
            names: Of `NAMES`.
        """
        solved = self.solve(self._parts.to_modes(residual[:, :, None]))
        wanted = [NAMES.index(name) for name in names]
        modal = 0.5 * self.changes(solved)[:, :, wanted].sum(axis=2)
        return self._parts.noise[:, None] ** 2 * (self._modes.turn @ modal)

    def _reduced(
        self, a: Float[np.ndarray, "loop m k"]
    ) -> tuple[Float[np.ndarray, "loop*m k"], Float[np.ndarray, "c k"]]:
        """D^−½ a in modes, and L⁻¹ VᵀD⁻¹a."""
        root = np.sqrt(self._variance)[:, :, None]
        plain = self._parts.to_modes(a) / root
        z = self._gathered(plain / root)
        z = solve_triangular(self._root, z, lower=True, check_finite=False)
        return plain.reshape(-1, a.shape[2]), z

    def _gathered(self, modal: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "c k"]:
        """Vᵀ of what is given in modes."""
        count, m, k = modal.shape
        at_loops = (self._modes.turn @ modal.reshape(count, -1)).reshape(count, m, k)
        every = np.moveaxis(self._at_loops @ at_loops, 1, 0)
        return self._narrowed(every.reshape(-1, k))

    def _spread(self, z: Float[np.ndarray, "c k"]) -> Float[np.ndarray, "loop m k"]:
        """V z in modes."""
        count, rank = self._modes.smooth.shape
        every = z[: self._alone].reshape(-1, count, z.shape[1])
        if rank:
            laws = self._modes.smooth @ z[self._alone :].reshape(-1, rank, z.shape[1])
            every = np.concatenate([every, laws])
        at_loops = np.swapaxes(self._at_loops, 1, 2) @ np.moveaxis(every, 0, 1)
        return self._parts.to_modes(at_loops)

    def _narrowed(self, every: Float[np.ndarray, "row k"]) -> Float[np.ndarray, "c k"]:
        """Rᵀ on the rows of the laws: from one row a kind and loop to one a column of V."""
        count, rank = self._modes.smooth.shape
        if not rank:
            return every
        k = every.shape[1]
        laws = self._modes.smooth.T @ every[self._alone :].reshape(-1, count, k)
        return np.concatenate([every[: self._alone], laws.reshape(-1, k)])

    def _coupled(self, weight: Float[np.ndarray, "loop m"]) -> Float[np.ndarray, "c c"]:
        """Vᵀ diag(weight) V, nothing above its diagonal blocks.

        Before R, with M_c = `turn` diag(weight of coefficient c) `turn`ᵀ, the block of two kinds is
        Σ_c diag(d_c) M_c diag(d'_c): loop by loop a product over c.

        Args:
            weight: [L, m] in modes, alike for the coefficients of one harmonic.
        """
        modes = self._modes
        count, kinds, _ = self._at_loops.shape
        of_each = np.ascontiguousarray(weight[:, modes.first].T)
        blocks = np.empty((kinds, kinds, count, count))  # kind of column, of row
        for some in self._portions():
            between = (modes.turn[some, None, :] * of_each).reshape(-1, count) @ modes.turn.T
            middle = between.reshape(-1, modes.first.size, count)[:, modes.group]
            for kind, reach in enumerate(self._reach):
                spread = middle[:, :reach] * self._across[kind, :reach]
                rows = self._at_loops[some, kind:, :reach] @ spread
                blocks[kind, kind:, some] = np.moveaxis(rows, 1, 0)
        out = np.zeros((self._columns[-1].stop, self._columns[-1].stop))
        for other in range(kinds):
            for one in range(other, kinds):
                block = blocks[other, one]
                block = modes.smooth.T @ block if self._is_law(one) else block
                block = block @ modes.smooth if self._is_law(other) else block
                out[self._columns[one], self._columns[other]] = block
        return out

    def _traced(self, below: Float[np.ndarray, "c c"]) -> Float[np.ndarray, "loop harmonic"]:
        """Derivatives of the trace of a product with `_coupled` by each weight.

        Args:
            below: What it is multiplied by, with nothing above its diagonal.

        Returns:
            [L, G], in modes, for the coefficients of one harmonic together.
        """
        modes = self._modes
        count, kinds, m = self._at_loops.shape
        blocks = np.empty((kinds, kinds, count, count))  # kind of column, of row
        for other in range(kinds):
            for one in range(other, kinds):
                block = below[self._columns[one], self._columns[other]]
                block = modes.smooth @ block if self._is_law(one) else block
                block = block @ modes.smooth.T if self._is_law(other) else block
                blocks[other, one] = block
        together = (modes.group == np.arange(modes.first.size)[:, None]).astype(float)
        out = np.zeros((modes.first.size, count))
        for some in self._portions():
            middle = np.zeros((some.stop - some.start, m, count))
            for kind, reach in enumerate(self._reach):
                rows = np.moveaxis(blocks[kind, kind:, some], 0, 1)
                spread = np.swapaxes(self._at_loops[some, kind:, :reach], 1, 2) @ rows
                spread *= self._across[kind, :reach]
                middle[:, :reach] += spread
            turned = (together @ middle).reshape(-1, count) @ modes.turn
            turned = turned.reshape(-1, modes.first.size, count)
            out += np.sum(turned * modes.turn[some, None, :], axis=0)
        return out.T

    def _portions(self) -> list[slice]:
        """Loops that are worked on together: what lies between them stays near the processor."""
        count = self._at_loops.shape[0]
        return [slice(k, min(k + PORTION, count)) for k in range(0, count, PORTION)]

    def _is_law(self, kind: int) -> bool:
        return kind >= self._of_rig

    def _ordered(
        self, varying: Float[np.ndarray, "kind ..."], structural: Float[np.ndarray, "2 ..."]
    ) -> Float[np.ndarray, "name ..."]:
        """One row a name, in the order of `NAMES`; zeros for what Σ does not have."""
        out = np.zeros((len(NAMES), *varying.shape[1:]))
        out[self._places] = varying
        out[[NAMES.index("odd"), NAMES.index("even")]] = structural
        return out
