r"""How probable each condition is, given all the others: the evidence that an effect must renew.

For y = Jβ + e, e ~ N(0, Σ), and nothing known of β, what the other tests say of those of
condition c is Gaussian, and with

    P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹

its logarithmic density at what was measured is

    ½ log|P_cc| − ½ (Pr)_cᵀ P_cc⁻¹ (Pr)_c − ½ n_c log 2π.

No model is fitted again: errors of the laws that are smooth over conditions are predicted from the
neighbours, as Σ has them.  An effect earns its place if the sum over conditions rises by more than
chance.
"""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.state import State
from sysid.likelihood.reml import full_rank

UNSEEN: Final = 1e-6
"""Precision, parts of the measurement's own, of what the other conditions say nothing of: without
this one a parameter would not be determined at all."""
CONFIRMED: Final = 0.5
"""Part of what an effect gains that conditions must gain by all the others: next to all where all
agree, though it may show in few of them; nothing where one condition alone speaks for it."""
_TWO_PI: Final = 2.0 * np.pi


def log_densities(evidence: Evidence, state: State) -> Float[np.ndarray, " condition"]:
    """Log predictive density of each condition by a model fitted to the others under its own Σ.

    Args:
        evidence: The campaign.
        state: The model.

    Source:
        Sundararajan and Keerthi, Neural Computation 13 (2001), for single points.
    """
    covariance = state.covariance
    jacobian = full_rank(state.gls.jacobian)
    residual = state.gls.residual
    n = jacobian.shape[2]
    known = np.concatenate([jacobian, residual[:, :, None]], axis=2)
    gram = covariance.inner(known, known)
    root = np.linalg.cholesky(gram[:n, :n])
    beta = np.linalg.solve(gram[:n, :n], gram[:n, n])
    found = []
    for number in np.unique(evidence.condition):
        picked = _unit_columns(evidence.condition == number, residual.shape)
        across = covariance.inner(picked, known)
        inside = covariance.inner(picked, picked)
        taken = np.linalg.solve(root, across[:, :n].T)
        p_cc = inside - taken.T @ taken
        pr_c = across[:, n] - across[:, :n] @ beta
        values, axes = np.linalg.eigh(p_cc)
        values = np.maximum(values, UNSEEN * np.diagonal(inside).max())
        along = axes.T @ pr_c
        found.append(0.5 * np.log(values / _TWO_PI).sum() - 0.5 * float(np.sum(along**2 / values)))
    return np.array(found)


def _unit_columns(rows: np.ndarray, shape: tuple[int, ...]) -> Float[np.ndarray, "loop m k"]:
    """One column for each coefficient of the chosen tests."""
    chosen = np.flatnonzero(rows)
    m = shape[1]
    columns = np.zeros((*shape, chosen.size * m))
    for place, row in enumerate(chosen):
        columns[row, :, place * m : (place + 1) * m] = np.eye(m)
    return columns


def renewed(
    before: Float[np.ndarray, " condition"], after: Float[np.ndarray, " condition"]
) -> float:
    """Gain of log predictive density over its standard error, over conditions."""
    gain = after - before
    return float(gain.sum() / max(np.sqrt(np.sum(gain**2)), 1e-300))
