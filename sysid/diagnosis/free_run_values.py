"""Values of the fit whose free run errs least, with their covariance under what Σ knows."""

from typing import Final

import numpy as np

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.quantities import Values, free_values, values_of
from sysid.diagnosis.state import State
from sysid.likelihood.carried import carried
from sysid.likelihood.discrepancy import Sizes
from sysid.uncertainty.directions import directions_of

UNDER_ERRORS: Final = "least squares of F/max|F| under errors of rig and laws (Σ by REML)"
BY_RESIDUAL: Final = "least squares of F/max|F|, errors as large as what is left"


def free_run_values(state: State, evidence: Evidence, sizes: Sizes) -> tuple[Values, str]:
    """Values of least squares with weights 1/max|F|, their covariance, and in words how.

    Least squares errs more than the fit under Σ does, since it weighs errors of rig and laws like
    noise: with B the inverse of Σ_l J_lᵀJ_l/p_l², the covariance is B (Gᵀ Σ G) B, G = J/p².

    Args:
        state: The fit (`plainly_fitted`).
        evidence: The campaign, with what Σ is made of about this model.
        sizes: Of the parts of Σ; without any, errors are taken from what the fit leaves.
    """
    if sizes == NONE:
        return free_values(state), BY_RESIDUAL
    weights = state.gls.jacobian / evidence.peak[:, None, None] ** 2
    seen, unseen = directions_of(np.einsum("lmi,lmj->ij", weights, state.gls.jacobian))
    error = carried(evidence.parts, sizes, weights).sum(axis=0)
    root = seen @ np.linalg.cholesky(_raised(seen.T @ error @ seen))
    return values_of(state, np.concatenate([root, unseen], axis=1)), UNDER_ERRORS


def _raised(matrix: np.ndarray) -> np.ndarray:
    """Positive definite by a rounding error of its largest entry."""
    least = 1e-12 * max(float(np.diagonal(matrix).max(initial=0.0)), 1e-300)
    return matrix + least * np.eye(len(matrix))
