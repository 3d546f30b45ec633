"""Sizes of the discrepancy covariance by restricted maximum likelihood (REML)."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_solve

from sysid.likelihood.discrepancy import LAWS, NAMES, Covariance, Parts, Sizes, Solved

PRIOR: Final = {
    "gain": 0.01, "offset": 0.005, "delay": 2e-4, "thermometer": 0.5, "odd": 0.01, "even": 0.005,
    "scale": 0.01, "width": 0.01, "steepness": 0.01, "growth": 0.01,
}  # fmt: skip
"""Where the search starts: ordinary rigs (1 %, an offset of 0.5 % of the median RMS force, 0.2 ms,
0.5 K) and an ordinary base model."""
PRIOR_WIDTH: Final = 1.5
"""Standard deviation of the log-normal prior about it: a factor of e^1.5 = 4.5 either way."""
_FLOOR: Final = 1e-3
_CEILING: Final = 6.0
"""Largest ln(size / where the search starts)."""
TIMES: Final = 3.0
"""An error of the laws, or a structural one, is at most so many times what least squares leaves.
Without that bound a large error lets the fitted parameters wander, what they then leave makes the
error look larger still, and in the end it explains everything."""
_LONGEST: Final = 1.0
"""Longest step in ln size: far away lie maxima in which one part of Σ explains everything."""
_MOST_STEPS: Final = 20
_HALVINGS: Final = 4
_TOLERANCE: Final = 0.03
"""Log-likelihood that a step must promise to be taken, and gain for another to be taken."""


@dataclass(frozen=True)
class Restricted:
    """The fitted covariance.

    Attributes:
        sizes: Standard deviations of its parts.
        covariance: Σ.
        log_likelihood: Restricted log-likelihood, up to a constant.
        spread: [name] standard deviation of ln size, in the order of `NAMES`, prior included: a
            size that the data say nothing about has the prior's.
    """

    sizes: Sizes
    covariance: Covariance
    log_likelihood: float
    spread: Float[np.ndarray, " name"]


def restricted_slopes(
    covariance: Covariance, modal: Float[np.ndarray, "loop m p"]
) -> tuple[float, Float[np.ndarray, " name"], Float[np.ndarray, "name name"]]:
    """Restricted log-likelihood, its derivatives and its average information.

    With θ = ln size, Σ_i = ∂Σ/∂θ_i and P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹,

        ℓ = −½ (ln|Σ| + ln|JᵀΣ⁻¹J| + rᵀPr),
        ∂ℓ/∂θ_i = −½ (tr PΣ_i − rᵀPΣ_iPr),   A_ij = ½ rᵀPΣ_i P Σ_jPr.

    A is the mean of observed and expected information, without the traces of either.

    Args:
        covariance: Σ.
        modal: [L, m, n + 1], the Jacobian, of full rank, and the residual in modes.

    Returns:
        ℓ, up to a constant; [name] slopes; [name, name] A; in the order of `NAMES`.

    Raises:
        numpy.linalg.LinAlgError: Σ or JᵀΣ⁻¹J is singular to rounding.

    Source:
        Patterson and Thompson, Biometrika 58 (1971); Gilmour, Thompson and Cullis, Biometrics 51
        (1995).
    """
    found = _Likelihood(covariance, modal)
    return found.value, found.slopes, found.information


class _Likelihood:
    """Restricted log-likelihood under Σ; its derivatives, most of the work, where asked for.

    Args:
        covariance: Σ.
        modal: [L, m, n + 1], as for `restricted_slopes`.

    Attributes:
        covariance: The same.
        value: ℓ, up to a constant.

    Raises:
        numpy.linalg.LinAlgError: Σ or JᵀΣ⁻¹J is singular to rounding.
    """

    covariance: Covariance
    value: float

    def __init__(self, covariance: Covariance, modal: Float[np.ndarray, "loop m p"]) -> None:
        self.covariance = covariance
        solved = covariance.solve(modal)
        n = self._absorbed = modal.shape[2] - 1
        gram = modal.reshape(-1, n + 1).T @ solved.modal.reshape(-1, n + 1)
        root = np.linalg.cholesky(gram[:n, :n])
        beta = cho_solve((root, True), gram[:n, -1])
        # columns of Σ⁻¹J (JᵀΣ⁻¹J)^−½ and P r
        onto = np.zeros((n + 1, n + 1))
        onto[:n, :n] = np.linalg.inv(root).T
        onto[:n, -1], onto[-1, -1] = -beta, 1.0
        self._solved = Solved(solved.modal @ onto, solved.columns @ onto)
        self.value = -0.5 * float(
            covariance.log_determinant
            + 2.0 * np.log(np.diagonal(root)).sum()
            + gram[-1, -1]
            - gram[:n, -1] @ beta
        )

    @cached_property
    def slopes(self) -> Float[np.ndarray, " name"]:
        """∂ℓ/∂θ."""
        inner = self.covariance.slopes_of_inner(self._solved)
        trace = self.covariance.slopes_of_log_determinant() - inner[:, :-1].sum(axis=1)
        return -0.5 * (trace - inner[:, -1])

    @cached_property
    def information(self) -> Float[np.ndarray, "name name"]:
        """A."""
        n, solved = self._absorbed, self._solved
        remains = Solved(solved.modal[:, :, -1:], solved.columns[:, -1:])
        changes = self.covariance.changes(remains)
        q = changes.reshape(-1, len(NAMES))
        absorbed = solved.modal[:, :, :n].reshape(-1, n).T @ q
        again = self.covariance.solve(changes).modal.reshape(-1, len(NAMES))
        return 0.5 * (q.T @ again - absorbed.T @ absorbed)


def fit_sizes(
    parts: Parts,
    residual: Float[np.ndarray, "loop m"],
    jacobian: Float[np.ndarray, "loop m n"],
    start: Sizes | None = None,
    absent: tuple[str, ...] = (),
    tolerance: float = _TOLERANCE,
    times: float = TIMES,
) -> Restricted:
    """Sizes that make the residual most probable, whatever the base parameters are.

    Args:
        parts: What Σ is made of.
        residual: [L, m] N, of the fitted base model.
        jacobian: [L, m, n], of its free parameters; columns that the data do not determine are
            dropped here.
        start: Of the search, where sizes near are known; ordinary ones if None.
        absent: Of `NAMES`, parts that Σ is to be without.
        tolerance: Log-likelihood that is not worth a step.
        times: Largest error of the laws, and structural one, in parts of `Parts.error`.
    """
    solid = full_rank(jacobian)
    modal = parts.to_modes(np.concatenate([solid, residual[:, :, None]], axis=2))

    ceiling = _ceilings(parts, times)
    start_at = np.zeros(len(NAMES)) if start is None else _place_of(start, parts)
    here = _posterior(parts, np.clip(start_at, np.log(_FLOOR), ceiling), modal, absent)
    for _ in range(_MOST_STEPS):
        step = _step(here, ceiling)
        if _promised(here, step, ceiling) < tolerance:
            break
        step *= min(1.0, _LONGEST / float(np.abs(step).max()))
        there = None
        for _ in range(_HALVINGS):
            trial = np.clip(here.z + step, np.log(_FLOOR), ceiling)
            there = _posterior(parts, trial, modal, absent)
            if there.value > here.value:
                break
            step, there = 0.3 * step, None
        if there is None:
            break
        gained, here = there.value - here.value, there
        if gained < tolerance:
            break
    found = here.likelihood
    if found is None:
        covariance = Covariance(parts, _sizes_at(here.z, parts, absent))
    else:
        covariance = found.covariance
    return Restricted(
        sizes=covariance.sizes,
        covariance=covariance,
        log_likelihood=here.value + 0.5 * float(np.sum((here.z / PRIOR_WIDTH) ** 2)),
        spread=np.sqrt(np.diagonal(np.linalg.inv(here.information))),
    )


def _step(here: "_Posterior", ceiling: Float[np.ndarray, " name"]) -> Float[np.ndarray, " name"]:
    """Step of those that lie inside their bounds, or that their slope leads back inside."""
    z, slopes = here.z, here.slopes
    held = ((z >= ceiling) & (slopes > 0.0)) | ((z <= np.log(_FLOOR)) & (slopes < 0.0))
    free = np.flatnonzero(~held)
    step = np.zeros_like(z)
    step[free] = np.linalg.solve(here.information[np.ix_(free, free)], slopes[free])
    return step


def _promised(
    here: "_Posterior", step: Float[np.ndarray, " name"], ceiling: Float[np.ndarray, " name"]
) -> float:
    """Log-likelihood that a step inside the bounds gains at most, by slopes and information."""
    move = np.clip(here.z + step, np.log(_FLOOR), ceiling) - here.z
    return float(here.slopes @ move - 0.5 * move @ here.information @ move)


def _ceilings(parts: Parts, times: float) -> Float[np.ndarray, " name"]:
    """Largest ln(size / where the search starts) of each part."""
    largest = np.full(len(NAMES), _CEILING)
    if not np.isfinite(parts.error):
        return largest
    most = times * parts.error
    reach = {"odd": 1.0, "even": 1.0}
    for name, change in zip(LAWS, parts.laws, strict=False):
        reach[name] = float(np.sqrt(np.sum(change**2) / np.sum(parts.force**2)))
    for name, by in reach.items():
        ratio = most / max(by, 1e-9) / PRIOR[name]
        largest[NAMES.index(name)] = np.clip(np.log(max(ratio, 1e-300)), np.log(_FLOOR), _CEILING)
    return largest


@dataclass(frozen=True)
class _Posterior:
    """Log-likelihood with the prior at z = ln(size / where the search starts).

    Attributes:
        z: [name].
        likelihood: The data's; None where Σ or JᵀΣ⁻¹J is singular to rounding.
    """

    z: Float[np.ndarray, " name"]
    likelihood: _Likelihood | None

    @property
    def value(self) -> float:
        """Pure number, up to a constant."""
        if self.likelihood is None:
            return -np.inf
        return self.likelihood.value - 0.5 * float(np.sum((self.z / PRIOR_WIDTH) ** 2))

    @property
    def slopes(self) -> Float[np.ndarray, " name"]:
        """By z."""
        if self.likelihood is None:
            return np.zeros_like(self.z)
        return self.likelihood.slopes - self.z / PRIOR_WIDTH**2

    @property
    def information(self) -> Float[np.ndarray, "name name"]:
        """Average information about z."""
        if self.likelihood is None:
            return np.eye(self.z.size)
        return self.likelihood.information + np.eye(self.z.size) / PRIOR_WIDTH**2


def _posterior(
    parts: Parts,
    z: Float[np.ndarray, " name"],
    modal: Float[np.ndarray, "loop m p"],
    absent: tuple[str, ...],
) -> _Posterior:
    try:
        found = _Likelihood(Covariance(parts, _sizes_at(z, parts, absent)), modal)
    except np.linalg.LinAlgError:
        found = None
    return _Posterior(z, found)


def _sizes_at(z: Float[np.ndarray, " name"], parts: Parts, absent: tuple[str, ...] = ()) -> Sizes:
    """Sizes of given ln(size / where the search starts); 0 for what Σ does not have."""
    sizes = {n: PRIOR[n] * float(np.exp(v)) for n, v in zip(NAMES, z, strict=True)}
    sizes["offset"] *= float(np.median(parts.scale))
    sizes.update(dict.fromkeys((*absent, *parts.absent), 0.0))
    return Sizes(**sizes)


def _place_of(sizes: Sizes, parts: Parts) -> Float[np.ndarray, " name"]:
    """ln(size / where the search starts)."""
    usual = _sizes_at(np.zeros(len(NAMES)), parts)
    pairs = [(getattr(sizes, name), getattr(usual, name)) for name in NAMES]
    return np.array([np.log(max(s / u, _FLOOR)) if u > 0.0 else 0.0 for s, u in pairs])


def full_rank(jacobian: Float[np.ndarray, "loop m n"]) -> Float[np.ndarray, "loop m k"]:
    """Orthonormal columns that span what the Jacobian spans."""
    loops, m, n = jacobian.shape
    flat = jacobian.reshape(-1, n)
    flat = flat / np.maximum(np.linalg.norm(flat, axis=0), 1e-300)
    left, singular, _ = np.linalg.svd(flat, full_matrices=False)
    kept = left[:, singular > 1e-7 * singular[0]]
    return kept.reshape(loops, m, -1)
