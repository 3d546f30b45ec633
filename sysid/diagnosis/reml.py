"""Sizes of the discrepancy covariance by restricted maximum likelihood (REML)."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from sysid.diagnosis.discrepancy import Covariance, Parts, Sizes

PRIOR: Final = {"gain": 0.01, "offset": 3.0, "delay": 2e-4, "odd": 0.01, "even": 0.005}
"""Where the search starts: ordinary rigs (1 %, 3 N, 0.2 ms) and an ordinary base model."""
PRIOR_WIDTH: Final = 1.5
"""Standard deviation of the log-normal prior about it: a factor of e^1.5 = 4.5 either way."""
_FLOOR: Final = 1e-3


@dataclass(frozen=True)
class Restricted:
    """The fitted covariance.

    Attributes:
        sizes: Standard deviations of its parts.
        covariance: Σ.
        log_likelihood: Restricted log-likelihood, up to a constant.
    """

    sizes: Sizes
    covariance: Covariance
    log_likelihood: float


def restricted_likelihood(
    covariance: Covariance,
    residual: Float[np.ndarray, "loop m"],
    jacobian: Float[np.ndarray, "loop m n"],
) -> float:
    """−½ (log|Σ| + log|JᵀΣ⁻¹J| + rᵀPr), P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹.

    Args:
        covariance: Σ.
        residual: [L, m] N.
        jacobian: [L, m, n] of the base model's free parameters, columns of full rank.

    Source:
        Patterson and Thompson, Biometrika 58 (1971).
    """
    both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
    gram = covariance.inner(both, both)
    sign, log_information = np.linalg.slogdet(gram[:-1, :-1])
    if sign <= 0.0:
        return -np.inf
    g = gram[:-1, -1]
    left = gram[-1, -1] - g @ np.linalg.solve(gram[:-1, :-1], g)
    return float(-0.5 * (covariance.log_determinant + log_information + left))


def fit_sizes(
    parts: Parts,
    residual: Float[np.ndarray, "loop m"],
    jacobian: Float[np.ndarray, "loop m n"],
) -> Restricted:
    """Sizes that make the residual most probable, whatever the base parameters are.

    Args:
        parts: What Σ is made of.
        residual: [L, m] N, of the fitted base model.
        jacobian: [L, m, n], of its free parameters; columns that the data do not determine are
            dropped here.
    """
    solid = full_rank(jacobian)
    names = tuple(PRIOR)

    def sizes_at(z: np.ndarray) -> Sizes:
        return Sizes(**{n: PRIOR[n] * float(np.exp(v)) for n, v in zip(names, z, strict=True)})

    def loss(z: np.ndarray) -> float:
        value = restricted_likelihood(Covariance(parts, sizes_at(z)), residual, solid)
        return -value + 0.5 * float(np.sum((z / PRIOR_WIDTH) ** 2)) if np.isfinite(value) else 1e300

    found = minimize(
        loss, np.zeros(len(names)), method="L-BFGS-B", bounds=[(np.log(_FLOOR), 6.0)] * len(names),
        options={"maxiter": 25, "ftol": 1e-7, "eps": 1e-3},
    )  # fmt: skip
    covariance = Covariance(parts, sizes_at(found.x))
    return Restricted(
        sizes_at(found.x), covariance, restricted_likelihood(covariance, residual, solid)
    )


def full_rank(jacobian: Float[np.ndarray, "loop m n"]) -> Float[np.ndarray, "loop m k"]:
    """Orthonormal columns that span what the Jacobian spans."""
    loops, m, n = jacobian.shape
    flat = jacobian.reshape(-1, n)
    flat = flat / np.maximum(np.linalg.norm(flat, axis=0), 1e-300)
    left, singular, _ = np.linalg.svd(flat, full_matrices=False)
    kept = left[:, singular > 1e-7 * singular[0]]
    return kept.reshape(loops, m, -1)
