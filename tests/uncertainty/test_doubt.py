"""A covariance that is not known: intervals as wide as its t distributions make them."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.likelihood.carried import carried
from sysid.likelihood.observed import observe
from sysid.uncertainty.covariance import NORMAL
from sysid.uncertainty.directions import directions_of
from sysid.uncertainty.doubt import Doubt, doubt_of
from sysid.uncertainty.error_model import ErrorModel, error_model
from sysid.uncertainty.reduced import reduce_likelihood
from sysid.uncertainty.spread import place_at, spread_under
from sysid.uncertainty.target import exact_log_likelihood, harmonics_at, target_of


@pytest.fixture(scope="module")
def full(made) -> ErrorModel:
    return error_model(made.fit, observe(made.loops), "full")


@pytest.fixture(scope="module")
def doubt(made, full) -> Doubt:
    return doubt_of(made.prior.coordinates, full)


def covariance_of(made, errors: ErrorModel) -> np.ndarray:
    """[n, n] of relative changes of the parameters under a likelihood that is quadratic in them:
    the inverse of what its second differences are."""
    place = place_at(made.fit.coordinates, errors.u)
    _, jacobian = errors.observed.look(place.relative, np.zeros(place.relative.size))
    axes = directions_of(errors.covariance.inner(jacobian, jacobian)).seen
    doubt = doubt_of(made.prior.coordinates, errors)

    def height(z: np.ndarray) -> float:
        r = jacobian @ (axes @ z)
        cost = errors.covariance.inner(r[:, :, None], r[:, :, None])[0, 0]
        return float(doubt.of(r[None])[0] - 0.5 * cost)

    unit = np.eye(axes.shape[1])
    alone = [height(e) for e in unit]
    curve = [
        [height(a + b) - p - q for b, q in zip(unit, alone, strict=True)]
        for a, p in zip(unit, alone, strict=True)
    ]
    return axes @ np.linalg.inv(-np.array(curve)) @ axes.T


def test_intervals_are_those_of_the_t_distributions(made, full):
    place, spread = spread_under(made.fit, full)
    sd = np.sqrt(np.diagonal(covariance_of(made, full)))
    expected = spread.quantile / NORMAL * np.sqrt(np.diagonal(spread.covariance))
    assert len(place.declared) == sd.size
    assert (expected / np.sqrt(spread.plain)).max() > 1.2
    np.testing.assert_allclose(sd, expected, rtol=1e-3)


def test_a_known_covariance_leaves_intervals_as_wide_as_it_says(made, full):
    known = replace(full, spread=None)
    _, spread = spread_under(made.fit, known)
    sd = np.sqrt(np.diagonal(covariance_of(made, known)))
    np.testing.assert_allclose(sd, np.sqrt(spread.plain), rtol=1e-3)


@pytest.mark.parametrize("kind", ["independent", "random_effects", "power"])
def test_likelihoods_without_errors_of_the_laws_take_theirs_for_known(made, full, doubt, kind):
    residual = np.random.default_rng(0).standard_normal((3, *full.observed.parts.force.shape))
    assert np.ptp(doubt.of(residual)) > 0.0
    errors = error_model(made.fit, observe(made.loops), kind)
    assert np.array_equal(doubt_of(made.prior.coordinates, errors).of(residual), np.zeros(3))


def test_numbers_of_a_right_covariance_are_independent_and_of_unit_variance(full, doubt):
    origin = carried(full.observed.parts, full.sizes, doubt.weights)
    np.testing.assert_allclose(origin.sum(axis=0), np.eye(doubt.weights.shape[2]), atol=1e-4)


def test_the_reduced_likelihood_doubts_as_much_as_the_whole_one(made, full, doubt):
    root = np.linalg.cholesky(np.linalg.inv(full.information + np.eye(7)))
    u = full.u + 1.5 * np.random.default_rng(1).standard_normal((200, 7)) @ root.T
    centre = harmonics_at(made.prior, full.observed, full.u[None])[0]
    draws = harmonics_at(made.prior, full.observed, u[:150])
    reduced = reduce_likelihood(full.observed, full.covariance, centre, draws, doubt.weights)
    target = target_of(made.prior, full, reduced, doubt)
    exact = exact_log_likelihood(made.prior, full, u[150:], doubt)
    sure = exact_log_likelihood(made.prior, full, u[150:])
    assert target.log_likelihood(u[150:]) == pytest.approx(exact, abs=0.01)
    assert np.max(exact - sure) > 0.5  # far out it is less sure
