"""Log-probability of parameters, for all walkers of an ensemble in one compiled call."""

from collections.abc import Callable
from typing import Any, Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from sysid.likelihood.gls import LARGEST
from sysid.likelihood.observed import Observed
from sysid.models.coordinates import AbstractCoordinates
from sysid.motion.motion import Motion
from sysid.uncertainty.doubt import Doubt
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.prior import Prior
from sysid.uncertainty.reduced import Reduced, at_few_points

LogProbability = Callable[[Float[np.ndarray, "walker n"]], Float[np.ndarray, " walker"]]

TOGETHER: Final = 8
"""Walkers whose loops are computed at once: so many fit into a processor's cache."""
CALL: Final = 24
"""Walkers of a call; always as many, so that one program is compiled."""
COLUMNS: Final = 32
"""B is filled up to a multiple of so many columns, for the same reason."""
TOLD_BY: Final = 600
"""Training draws at most that points are chosen by."""
CHUNK: Final = 64
"""Places whose loops are held in memory at once where the exact likelihood is asked for."""


class Target(eqx.Module):
    """Prior times likelihood, the likelihood reduced to a few numbers a model evaluation.

    Attributes:
        prior: Of u.
        motion: Of the tests.
        B: [L·P, n + q] of `Reduced`.
        a: [n + q].
        rest: ρ.
        power: β of the likelihood.
        root: [n, n] of `Doubt`.
    """

    prior: Prior
    motion: Motion
    B: Float[Array, "points columns"]
    a: Float[Array, " columns"]
    rest: Float[Array, ""]
    power: Float[Array, ""]
    root: Float[Array, "n n"]

    def __call__(self, u: Float[np.ndarray, "walker n"]) -> Float[np.ndarray, " walker"]:
        """Log-probability of each walker, up to a constant; −∞ where the model is not finite."""
        return _in_calls(lambda some: _log_probability(self, some), u)

    def at(self, u: Float[Array, " n"]) -> Float[Array, ""]:
        """Log-probability at one place, for samplers that need its slopes."""
        both = self.prior.log_density(u) + _of_data(self, u)
        return jnp.where(jnp.isnan(both), -jnp.inf, both)

    def log_likelihood(self, u: Float[np.ndarray, "walker n"]) -> Float[np.ndarray, " walker"]:
        """Its part that the data have: −½β rᵀΣ⁻¹r, and what other Σs make of it."""
        return _in_calls(lambda some: _log_likelihood(self, some), u)


def target_of(prior: Prior, errors: ErrorModel, reduced: Reduced, doubt: Doubt) -> Target:
    """Put the pieces together."""
    more = -reduced.a.size % COLUMNS
    return Target(
        prior,
        motion_at(errors.observed, reduced.points),
        jnp.asarray(np.pad(reduced.B, ((0, 0), (0, more)))),
        jnp.asarray(np.pad(reduced.a, (0, more))),
        jnp.asarray(reduced.rest),
        jnp.asarray(errors.power),
        jnp.asarray(doubt.root),
    )


def motion_of(observed: Observed) -> Motion:
    """Of the tests alone, without what they were filled up with."""
    return jax.tree.map(lambda z: z[: observed.tests], observed.motion)


def motion_at(observed: Observed, points: Int[np.ndarray, " points"]) -> Motion:
    """Of all tests, or at some of their points, one row: not for models with memory."""
    motion, shape = motion_of(observed), observed.force.shape
    if points.size == observed.force.size:
        return motion
    return jax.tree.map(lambda z: jnp.broadcast_to(z, shape).ravel()[points][None], motion)


def few_points(
    prior: Prior, errors: ErrorModel, reduced: Reduced, u: Float[np.ndarray, "draw n"]
) -> Reduced:
    """The reduced likelihood at few points, where the model has no memory and they tell enough.

    Args:
        prior: Of u.
        errors: The likelihood.
        reduced: At all points.
        u: Training draws.
    """
    observed = errors.observed
    u = u[:: -(-len(u) // TOLD_BY)]
    forces = _at(prior, motion_of(observed), u)
    fewer = at_few_points(reduced, forces)
    if fewer is None:
        return reduced
    alone = _at(prior, motion_at(observed, fewer.points), u[:CHUNK])
    together = forces[:CHUNK, fewer.points]
    same = np.allclose(alone, together, rtol=1e-9, atol=1e-9 * float(np.abs(together).max()))
    return fewer if same else reduced


def _at(prior: Prior, motion: Motion, u: np.ndarray) -> np.ndarray:
    """Forces [draw, points], N."""
    filled = np.concatenate([u, np.repeat(u[-1:], -len(u) % CHUNK, axis=0)])
    found = [
        np.asarray(_forces(prior, motion, jnp.asarray(filled[k : k + CHUNK])))
        for k in range(0, len(filled), CHUNK)
    ]
    return np.concatenate(found)[: len(u)]


def exact_log_likelihood(
    prior: Prior,
    errors: ErrorModel,
    u: Float[np.ndarray, "draw n"],
    doubt: Doubt | None = None,
) -> Float[np.ndarray, " draw"]:
    """−½β rᵀΣ⁻¹r by Σ itself; −∞ where the model is not finite.

    Args:
        prior: Of u.
        errors: The likelihood.
        u: [D, n].
        doubt: Other Σs that may be right, if they are to count.
    """
    found = []
    for first in range(0, len(u), CHUNK):
        residual = errors.observed.measured - harmonics_at(
            prior, errors.observed, u[first : first + CHUNK]
        )
        fine = np.abs(residual).max(axis=(1, 2)) < LARGEST
        residual = np.where(fine[:, None, None], residual, 0.0)
        white = errors.covariance.whiten(np.moveaxis(residual, 0, 2))
        value = -0.5 * errors.power * np.sum(white**2, axis=0)
        if doubt is not None:
            value = value + doubt.of(residual)
        found.append(np.where(fine, value, -np.inf))
    return np.concatenate(found)


def harmonics_at(
    prior: Prior, observed: Observed, u: Float[np.ndarray, "draw n"]
) -> Float[np.ndarray, "draw loop m"]:
    """Harmonics of the simulated loops at each of some places, N."""
    return harmonics_of(prior.coordinates, observed, u)


def harmonics_of(
    coordinates: AbstractCoordinates[Any], observed: Observed, u: Float[np.ndarray, "draw n"]
) -> Float[np.ndarray, "draw loop m"]:
    """The same of any coordinates."""
    motion, found = motion_of(observed), []
    for first in range(0, len(u), CHUNK):
        some = u[first : first + CHUNK]
        filled = np.concatenate([some, np.repeat(some[-1:], CHUNK - len(some), axis=0)])
        forces = _harmonics(coordinates, motion, observed.columns, jnp.asarray(filled))
        found.append(np.asarray(forces)[: len(some)])
    return np.concatenate(found)


def _in_calls(call: Callable[[Array], Array], u: np.ndarray) -> np.ndarray:
    filled = np.concatenate([u, np.repeat(u[-1:], -len(u) % CALL, axis=0)])
    found = [call(jnp.asarray(filled[k : k + CALL])) for k in range(0, len(filled), CALL)]
    return np.concatenate([np.asarray(z) for z in found])[: len(u)]


def _force(prior: Prior, motion: Motion, u: Array) -> Array:
    return prior.coordinates.valve(u).force(motion)


@eqx.filter_jit
def _forces(prior: Prior, motion: Motion, u: Array) -> Array:
    return jax.vmap(lambda z: _force(prior, motion, z).ravel())(u)


@eqx.filter_jit
def _harmonics(
    coordinates: AbstractCoordinates[Any], motion: Motion, columns: Array, u: Array
) -> Array:
    return jax.vmap(lambda z: coordinates.valve(z).force(motion) @ columns)(u)


@eqx.filter_jit
def _log_likelihood(target: Target, u: Array) -> Array:
    return _likelihood(target, u)


@eqx.filter_jit
def _log_probability(target: Target, u: Array) -> Array:
    density = jax.vmap(target.prior.log_density)(u)
    both = density + _likelihood(target, u)
    return jnp.where(jnp.isnan(both), -jnp.inf, both)


def _of_data(target: Target, u: Array) -> Array:
    """Log-likelihood at one place."""
    left = target.a - _force(target.prior, target.motion, u).ravel() @ target.B
    s, others = jnp.split(left, target.root.shape[:1])
    cost = target.rest + jnp.sum(others**2)
    doubt = jnp.sum(s**2) - jnp.sum((s @ target.root) ** 2)
    return 0.5 * doubt - 0.5 * target.power * cost


def _likelihood(target: Target, u: Array) -> Array:
    value = jax.lax.map(lambda z: _of_data(target, z), u, batch_size=TOGETHER)
    return jnp.where(jnp.isnan(value), -jnp.inf, value)


@eqx.filter_jit
def _log_density(prior: Prior, u: Array) -> Array:
    return jax.vmap(prior.log_density)(u)


def log_prior(prior: Prior, u: Float[np.ndarray, "draw n"]) -> Float[np.ndarray, " draw"]:
    """Log-density of the prior at some places."""
    return np.asarray(_log_density(prior, jnp.asarray(u)))


@eqx.filter_jit
def _parameters(prior: Prior, u: Array) -> Array:
    return jax.vmap(prior.parameters)(u)


def parameters_at(prior: Prior, u: Float[np.ndarray, "draw n"]) -> Float[np.ndarray, "draw n"]:
    """Free parameters of some places, in their units."""
    return np.asarray(_parameters(prior, jnp.asarray(u)))
