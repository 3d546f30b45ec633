"""REML: derivatives against differences, average information against the dense matrix, and sizes
recovered with honest spreads from data drawn from Σ itself."""

import numpy as np
import pytest

from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import NAMES, Parts, Sizes, covariance_parts
from sysid.likelihood.reml import (
    PRIOR,
    PRIOR_WIDTH,
    fit_sizes,
)
from tests.diagnosis.test_lack_of_fit import POINTS, campaign
from tests.likelihood.dense import (
    average_information_is_that_of_the_matrix,
    dense,
    draw,
    jacobian_of,
    slopes_are_differences,
)
from tests.likelihood.test_discrepancy import SIZES

PRESENT = [n for n in NAMES if getattr(SIZES, n)]
"""Sizes that Σ has without laws."""


@pytest.fixture(scope="module")
def parts() -> Parts:
    loops = campaign(
        lambda x, v, a, A, f, i: (200 + 1500 * i) * np.tanh(v / 0.01) + 300 * v, noise=5.0
    )
    return covariance_parts(loops, harmonic_basis(POINTS))


def test_slopes_are_those_of_the_likelihood(parts):
    elsewhere = Sizes(gain=0.01, offset=6.0, delay=2e-4, odd=0.02, even=0.02)
    slopes_are_differences(parts, SIZES, elsewhere)


def test_average_information_is_that_of_the_dense_matrix(parts):
    average_information_is_that_of_the_matrix(parts, SIZES)


def test_spreads_are_honest(parts):
    """Over draws from Σ, (ln found − ln true) / spread has standard deviation 1.

    Its mean is −0.2 over two hundred draws: ln of a standard deviation from thirty loops is skewed,
    and its mode lies low.  Of forty, 3.3 standard errors of a standard deviation are 0.37 and of a
    mean 0.52.
    """
    root = np.linalg.cholesky(dense(parts, SIZES))
    jacobian, truth = jacobian_of(parts), np.log([getattr(SIZES, n) for n in PRESENT])
    scores = []
    for seed in range(40):
        z = np.random.default_rng(seed).standard_normal(root.shape[0])
        found = fit_sizes(parts, (root @ z).reshape(parts.force.shape), jacobian)
        sizes = np.log([getattr(found.sizes, n) for n in PRESENT])
        scores.append((sizes - truth) / found.spread[[NAMES.index(n) for n in PRESENT]])
    scores = np.array(scores)
    assert 0.90 <= np.mean(np.abs(scores) < 1.96) <= 0.99
    assert np.all(np.abs(scores.mean(axis=0) + 0.2) < 0.52)
    assert np.all((scores.std(axis=0) > 0.63) & (scores.std(axis=0) < 1.37))


def test_a_size_that_the_data_are_silent_about_keeps_the_prior(parts):
    """Without any rate of force, a delay does nothing."""
    still = Parts(
        noise=parts.noise, force=parts.force, rate=np.zeros_like(parts.rate),
        scale=parts.scale, order=parts.order, kernel=parts.kernel,
    )  # fmt: skip
    found = fit_sizes(still, draw(still, SIZES, 7), still.force[:, :, None])
    assert found.sizes.delay == pytest.approx(PRIOR["delay"], rel=1e-2)
    assert found.spread[NAMES.index("delay")] == pytest.approx(PRIOR_WIDTH, rel=1e-6)
