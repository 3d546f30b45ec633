r"""How probable each condition is, given all the others: the evidence that an effect must renew.

For y = Jβ + e, e ~ N(0, Σ), and nothing known of β, what the other tests say of those of
condition c is Gaussian, and with

    P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹

its logarithmic density at what was measured is

    ½ log|P_cc| − ½ (Pr)_cᵀ P_cc⁻¹ (Pr)_c − ½ n_c log 2π.

No model is fitted again: errors of the laws that are smooth over conditions are predicted from the
neighbours, as Σ has them.  An effect earns its place if the sum over conditions rises by more than
chance.

Along a direction in which a parameter is known from condition c alone, nothing is predicted there:
the model follows whatever was measured.  Models are compared in what both of them predict.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.state import State
from sysid.likelihood.reml import full_rank

UNSEEN: Final = 1e-6
"""Precision, parts of the measurement's own, of what the other conditions say nothing of: without
this one a parameter would not be determined at all."""
CONFIRMED: Final = 1.0 / 3.0
"""Part of what an effect gains that conditions must gain by all the others: next to all where all
agree, though it may show in few of them; nothing where one condition alone speaks for it.  Small
effects of the catalogue kept .43 and more of it, a limit that one condition reaches .06 to .25."""
_TWO_PI: Final = 2.0 * np.pi


def log_densities(evidence: Evidence, state: State) -> Float[np.ndarray, " condition"]:
    """Log predictive density of each condition by a model fitted to the others under its own Σ.

    Args:
        evidence: The campaign.
        state: The model.

    Source:
        Sundararajan and Keerthi, Neural Computation 13 (2001), for single points.
    """
    return np.array([_log_density(*one) for one in _conditions(evidence, state)])


def density_gains(
    evidence: Evidence, before: State, after: State
) -> Float[np.ndarray, " condition"]:
    """What each condition's log predictive density rises by, in all that both models predict of it.

    Args:
        evidence: The campaign.
        before: A model.
        after: The same with effects.
    """
    found = []
    for one, other in zip(_conditions(evidence, before), _conditions(evidence, after), strict=True):
        blind = np.concatenate([_unpredicted(*one), _unpredicted(*other)], axis=1)
        seen = _orthogonal_to(blind)
        first, last = (_log_density(*_within(p, pr, floor, seen)) for p, pr, floor in (one, other))
        found.append(last - first)
    return np.array(found)


_OfCondition = tuple[Float[np.ndarray, "k k"], Float[np.ndarray, " k"], float]
"""P_cc, (Pr)_c, and the least precision that counts."""


def _conditions(evidence: Evidence, state: State) -> Iterator[_OfCondition]:
    """What a model says of each condition, given the others."""
    covariance = state.covariance
    jacobian = full_rank(state.gls.jacobian)
    residual = state.gls.residual
    n = jacobian.shape[2]
    known = np.concatenate([jacobian, residual[:, :, None]], axis=2)
    gram = covariance.inner(known, known)
    root = np.linalg.cholesky(gram[:n, :n])
    beta = np.linalg.solve(gram[:n, :n], gram[:n, n])
    for number in np.unique(evidence.condition):
        picked = _unit_columns(evidence.condition == number, residual.shape)
        across = covariance.inner(picked, known)
        inside = covariance.inner(picked, picked)
        taken = np.linalg.solve(root, across[:, :n].T)
        floor = UNSEEN * float(np.diagonal(inside).max())
        yield inside - taken.T @ taken, across[:, n] - across[:, :n] @ beta, floor


def _log_density(
    precision: Float[np.ndarray, "k k"], shift: Float[np.ndarray, " k"], floor: float = 0.0
) -> float:
    """Of a Gaussian in c at what was measured, from P_cc and (Pr)_c."""
    values, axes = np.linalg.eigh(precision)
    values = np.maximum(values, floor)
    along = axes.T @ shift
    return 0.5 * float(np.log(values / _TWO_PI).sum() - np.sum(along**2 / values))


def _unpredicted(
    precision: Float[np.ndarray, "k k"], _: Float[np.ndarray, " k"], floor: float
) -> Float[np.ndarray, "k d"]:
    """Directions in which the other conditions say nothing."""
    values, axes = np.linalg.eigh(precision)
    return axes[:, values < floor]


def _orthogonal_to(blind: Float[np.ndarray, "k d"]) -> Float[np.ndarray, "k s"]:
    """The other directions."""
    if blind.shape[1] == 0:
        return np.eye(blind.shape[0])
    left, singular, _ = np.linalg.svd(blind)
    return left[:, int((singular > 1e-6).sum()) :]


def _within(
    precision: Float[np.ndarray, "k k"],
    shift: Float[np.ndarray, " k"],
    floor: float,
    seen: Float[np.ndarray, "k s"],
) -> tuple[Float[np.ndarray, "s s"], Float[np.ndarray, " s"]]:
    """The same of the marginal density in some directions."""
    values, axes = np.linalg.eigh(precision)
    spread = (axes / np.maximum(values, floor)) @ axes.T
    inside = np.linalg.inv(seen.T @ spread @ seen)
    return 0.5 * (inside + inside.T), inside @ (seen.T @ (spread @ shift))


def _unit_columns(rows: np.ndarray, shape: tuple[int, ...]) -> Float[np.ndarray, "loop m k"]:
    """One column for each coefficient of the chosen tests."""
    chosen = np.flatnonzero(rows)
    m = shape[1]
    columns = np.zeros((*shape, chosen.size * m))
    for place, row in enumerate(chosen):
        columns[row, :, place * m : (place + 1) * m] = np.eye(m)
    return columns


def renewed(gains: Float[np.ndarray, " condition"]) -> float:
    """Gain of log predictive density over its standard error, over conditions."""
    return float(gains.sum() / max(np.sqrt(np.sum(gains**2)), 1e-300))
