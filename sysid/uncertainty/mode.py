"""Where the posterior is highest in solver coordinates, and how wide it is there."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.prior import Prior
from sysid.uncertainty.target import exact_log_likelihood, log_prior

STEP: Final = 1e-3
"""Of the differences that give the slopes of the prior; solver coordinates are of order one."""
INSIDE: Final = 6.0
"""Coordinates further out mean a parameter at a bound or beyond what changes anything: the search
starts inside."""
LONGEST: Final = 2.0
LEAST_CURVATURE: Final = 0.05
"""Of the log-probability: a width of 4.5 in a coordinate of order one is as good as none."""
_MOST_STEPS: Final = 40
_MOST_DAMPING: Final = 1e8
_TOLERANCE: Final = 1e-2


@dataclass(frozen=True)
class Mode:
    """The mode and the normal density that fits it.

    Attributes:
        u: [n].
        covariance: [n, n].
    """

    u: Float[np.ndarray, " n"]
    covariance: Float[np.ndarray, "n n"]


def find_mode(prior: Prior, errors: ErrorModel) -> Mode:
    """Damped Newton steps from the GLS fit, which need not be where the prior allows anything.

    It only helps chains to start well, so it is not carried further than to 0.01 of the
    log-probability.

    Args:
        prior: Of u.
        errors: The likelihood.
    """
    covariance, coordinates = errors.covariance, prior.coordinates

    def height(u: np.ndarray) -> float:
        value = exact_log_likelihood(prior, errors, u[None])[0] + log_prior(prior, u[None])[0]
        return float(value) if np.isfinite(value) else -np.inf

    u = _inside(prior, errors.u)
    here, damping = height(u), 1e-2
    for _ in range(_MOST_STEPS):
        residual, jacobian = errors.observed.look(coordinates, u)
        slope, curve = prior_slopes(prior, u)
        pull = covariance.inner(jacobian, residual[:, :, None])[:, 0]
        downhill = errors.power * pull + slope
        values, axes = _curvature(errors.power * covariance.inner(jacobian, jacobian) - curve)
        gained = 0.0
        while damping < _MOST_DAMPING:
            move = axes @ ((axes.T @ downhill) / (values * (1.0 + damping)))
            move *= min(1.0, LONGEST / max(float(np.abs(move).max()), 1e-300))
            there = height(u + move)
            if there > here:
                gained, here, u = there - here, there, u + move
                damping = max(0.1 * damping, 1e-6)
                break
            damping *= 8.0
        if gained < _TOLERANCE:
            break
    _, jacobian = errors.observed.look(coordinates, u)
    _, curve = prior_slopes(prior, u)
    values, axes = _curvature(errors.power * covariance.inner(jacobian, jacobian) - curve)
    return Mode(u, (axes / values) @ axes.T)


def prior_slopes(
    prior: Prior, u: Float[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, "n n"]]:
    """Slopes and curvature of the log-prior, by central differences."""
    n = u.size
    i, j = np.triu_indices(n)
    steps = STEP * np.eye(n)
    places = [
        steps, -steps, steps[i] + steps[j], steps[i] - steps[j],
        steps[j] - steps[i], -steps[i] - steps[j],
    ]  # fmt: skip
    values = log_prior(prior, u + np.concatenate(places))
    values = np.where(np.isfinite(values), values, 0.0)
    slope = (values[:n] - values[n : 2 * n]) / (2.0 * STEP)
    pp, pm, mp, mm = values[2 * n :].reshape(4, -1)
    curve = np.zeros((n, n))
    curve[i, j] = curve[j, i] = (pp - pm - mp + mm) / (4.0 * STEP**2)
    return slope, curve


def _inside(prior: Prior, u: np.ndarray) -> np.ndarray:
    """The place, or one nearer to the campaign's own scales where the prior does not allow it."""
    if not np.isfinite(log_prior(prior, u[None])[0]):
        u = np.clip(u, -INSIDE, INSIDE)
    return np.clip(u, -2.0 * INSIDE, 2.0 * INSIDE)


def _curvature(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    values, axes = np.linalg.eigh(0.5 * (matrix + matrix.T))
    return np.maximum(np.abs(values), LEAST_CURVATURE), axes
