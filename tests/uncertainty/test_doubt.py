"""A covariance that is not known: intervals as wide as its t distributions make them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import t

from sysid.cli.selection import select
from sysid.data.campaign import load_campaign
from sysid.identification.fit import fit_loops
from sysid.likelihood.carried import carried
from sysid.likelihood.observed import observe
from sysid.uncertainty.covariance import NORMAL
from sysid.uncertainty.directions import directions_of
from sysid.uncertainty.doubt import Doubt, doubt_of
from sysid.uncertainty.error_model import ErrorModel, error_model
from sysid.uncertainty.reduced import reduce_likelihood
from sysid.uncertainty.sample import observed_of
from sysid.uncertainty.spread import LEAST_FREEDOM, mean_spread, spread_under
from sysid.uncertainty.target import exact_log_likelihood, harmonics_at, target_of

LOW = Path(__file__).parents[2] / "datasets" / "virtual-w11-low"
WIDEST = float(t(LEAST_FREEDOM).ppf(0.975))


@pytest.fixture(scope="module")
def full(made) -> ErrorModel:
    return error_model(made.fit, observe(made.loops), "full")


@pytest.fixture(scope="module")
def doubt(made, full) -> Doubt:
    return doubt_of(made.prior.coordinates, full)


def widened(doubt: Doubt) -> np.ndarray:
    """[n, n] S̃, of the numbers that are of unit variance if Σ is right."""
    return np.linalg.inv(doubt.root @ doubt.root.T)


def test_each_axis_is_as_wide_as_its_t_distribution(full, doubt):
    values, axes = np.linalg.eigh(widened(doubt))
    n = values.size
    spread = mean_spread(np.eye(n), doubt.weights @ axes, full.observed.parts, full.believed())
    expected = spread.quantile / NORMAL * np.sqrt(np.diagonal(spread.covariance))
    np.testing.assert_allclose(np.sqrt(values), expected, rtol=1e-3)
    assert expected.max() > 1.2


def test_intervals_of_parameters_are_about_those_of_their_t_distributions(made, full, doubt):
    """A sum of axes is known a little better than each of them, which parameters' own t count."""
    place, spread = spread_under(made.fit, full)
    _, jacobian = full.observed.look(place.relative, np.zeros(place.relative.size))
    R = directions_of(full.covariance.inner(jacobian, jacobian)).seen
    sd = np.sqrt(np.diagonal(R @ widened(doubt) @ R.T))
    ratio = sd / (spread.quantile / NORMAL * np.sqrt(np.diagonal(spread.covariance)))
    assert ratio.min() > 0.95
    assert ratio.max() < 1.35


def test_what_is_known_of_parameters_together_stays_known():
    """I_1 and k_3 are open in this campaign and trade with parameters of other t quantiles: each
    widened by its own, one axis became 26 times wider, and another known almost exactly."""
    loops = select(load_campaign(LOW), (), ()).loops
    fit = fit_loops(loops)
    errors = error_model(fit, observed_of(fit, loops), "full")
    doubt = doubt_of(fit.coordinates, errors)
    n = doubt.weights.shape[2]
    spread = mean_spread(np.eye(n), doubt.weights, errors.observed.parts, errors.believed())
    values, largest = np.linalg.eigvalsh(widened(doubt)), np.linalg.eigvalsh(spread.covariance)[-1]
    assert values.min() > 0.5
    assert values.max() < 1.05 * (WIDEST / NORMAL) ** 2 * largest


@pytest.mark.parametrize("kind", ["independent", "random_effects", "power"])
def test_likelihoods_without_errors_of_the_laws_take_theirs_for_known(made, full, doubt, kind):
    residual = np.random.default_rng(0).standard_normal((3, *full.observed.parts.force.shape))
    assert np.ptp(doubt.of(residual)) > 0.0
    errors = error_model(made.fit, observe(made.loops), kind)
    assert np.array_equal(doubt_of(made.prior.coordinates, errors).of(residual), np.zeros(3))


def test_a_known_covariance_is_not_doubted(made, full, doubt):
    residual = np.random.default_rng(0).standard_normal((3, *full.observed.parts.force.shape))
    known = replace(full, spread=None)
    assert np.array_equal(doubt_of(made.prior.coordinates, known).of(residual), np.zeros(3))


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
