"""A covariance that is not known: as wide as its t distributions, and as often right as it says."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.likelihood.carried import carried
from sysid.likelihood.discrepancy import NAMES
from sysid.likelihood.observed import observe
from sysid.uncertainty.covariance import LEVEL
from sysid.uncertainty.doubt import Doubt, doubt_of
from sysid.uncertainty.error_model import ErrorModel, error_model
from sysid.uncertainty.reduced import reduce_likelihood
from sysid.uncertainty.spread import mean_spread, unsure
from sysid.uncertainty.target import exact_log_likelihood, harmonics_at, target_of


@pytest.fixture(scope="module")
def full(made) -> ErrorModel:
    return error_model(made.fit, observe(made.loops), "full")


@pytest.fixture(scope="module")
def doubt(made, full) -> Doubt:
    return doubt_of(made.prior.coordinates, full)


def half_widths(doubt: Doubt) -> np.ndarray:
    """[n] of 95 % intervals of each number of s, the others integrated out: normal mixtures."""
    root = np.asarray(doubt.mixture.root)
    covariance = np.linalg.inv(np.einsum("ikn,jkn->kij", root, root))
    sd = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    drawn = np.random.default_rng(3).standard_normal((4000, *sd.shape)) * sd
    return np.quantile(np.abs(drawn.reshape(-1, sd.shape[1])), LEVEL, axis=0)


def test_intervals_are_no_narrower_than_those_of_the_t_distributions(made, full):
    """Sizes known to a third, as of a hundred tests: each alone is known less well than their sum,
    which those take for one size."""
    believed = tuple(replace(one, spread=0.25 * one.spread) for one in full.believed())
    doubt = doubt_of(made.prior.coordinates, replace(full, plausible=believed))
    n = doubt.weights.shape[2]
    spread = mean_spread(np.eye(n), doubt.weights, full.observed.parts, believed)
    expected = spread.quantile * np.sqrt(np.diagonal(spread.covariance))
    ratio = half_widths(doubt) / expected
    assert ratio.min() > 0.97
    assert ratio.max() < 1.2


def test_what_is_known_is_not_doubted(made, full, doubt):
    """Neither of likelihoods without errors of the laws, nor of a Σ with sizes that are known."""
    residual = np.random.default_rng(0).standard_normal((3, *full.observed.parts.force.shape))
    assert np.ptp(doubt.of(residual)) > 0.0
    known = (
        replace(full, spread=None),
        *(error_model(made.fit, observe(made.loops), k) for k in ("random_effects", "power")),
    )
    for errors in known:
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


@pytest.mark.parametrize(
    ("times", "low", "high"), [(1.0, 0.93, 0.97), (0.6, 0.7, 0.9), (1.6, 0.985, 1.0)]
)
def test_intervals_hold_as_often_as_they_say(made, full, times, low, high):
    """Sizes as unknown as REML says, drawn anew: right, too narrow and too wide."""
    rng = np.random.default_rng(5)
    one = replace(full.believed()[0], weight=1.0)
    doubt = doubt_of(made.prior.coordinates, replace(full, plausible=(one,)))
    sd, n = unsure(one), doubt.weights.shape[2]
    origin = carried(one.of(full.observed.parts), one.sizes, doubt.weights)
    freedom = np.maximum(0.5 / np.maximum(sd, 1e-3) ** 2, 3.0)
    factors = np.where(sd > 1e-3, freedom / rng.chisquare(freedom, (3000, len(NAMES))), 1.0)
    true = origin[0] + np.einsum("ki,inm->knm", factors, origin[1:])
    s = np.einsum("knm,km->kn", np.linalg.cholesky(true), rng.standard_normal((3000, n)))
    assert low < np.mean(np.abs(s) <= times * half_widths(doubt)) < high
