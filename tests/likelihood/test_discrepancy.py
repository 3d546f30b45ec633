"""The discrepancy covariance: exact algebra, and sizes recovered from data that have them."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import Covariance, Sizes, covariance_parts
from sysid.likelihood.reml import fit_sizes
from tests.diagnosis.test_lack_of_fit import FORCES, POINTS, campaign
from tests.likelihood.dense import dense, draw, jacobian_of, restricted_likelihood

BASIS = harmonic_basis(POINTS)
SIZES = Sizes(gain=0.02, offset=4.0, delay=3e-4, odd=0.03, even=0.01)


@pytest.fixture(scope="module")
def parts():
    loops = campaign(
        lambda x, v, a, A, f, i: (200 + 1500 * i) * np.tanh(v / 0.01) + 300 * v, noise=5.0
    )
    return covariance_parts(loops, BASIS)


def test_basis_is_orthonormal_and_exact_for_its_harmonics():
    np.testing.assert_allclose(
        BASIS.columns.T @ BASIS.columns, POINTS * np.eye(31), atol=1e-10 * POINTS
    )
    phase = 2 * np.pi * np.arange(POINTS) / POINTS
    loop = 3.0 + 2.0 * np.sin(phase) - 0.5 * np.cos(15 * phase)
    np.testing.assert_allclose(BASIS.compress(loop) @ BASIS.columns.T, loop, atol=1e-12)
    assert np.sum(BASIS.compress(loop) ** 2) == pytest.approx(np.mean(loop**2))


def test_a_grid_too_coarse_is_refused():
    with pytest.raises(ValueError, match="cannot carry 15 harmonics"):
        harmonic_basis(30)


EVERY_SIZES = [
    SIZES,
    Sizes(gain=0.01, offset=1.0, delay=1e-4),
    Sizes(gain=0.0, offset=0.0, delay=0.0, odd=0.02),
    Sizes(gain=0.0, offset=0.0, delay=0.0),
]


@pytest.mark.parametrize("sizes", EVERY_SIZES)
def test_solves_and_determinant_are_those_of_the_dense_matrix(parts, sizes):
    rng = np.random.default_rng(0)
    a, b = (rng.standard_normal((*parts.force.shape, k)) for k in (2, 3))
    sigma = dense(parts, sizes)
    covariance = Covariance(parts, sizes)
    expected = a.reshape(-1, 2).T @ np.linalg.solve(sigma, b.reshape(-1, 3))
    np.testing.assert_allclose(covariance.inner(a, b), expected, rtol=1e-6, atol=1e-9)
    assert covariance.log_determinant == pytest.approx(np.linalg.slogdet(sigma)[1], rel=1e-9)


@pytest.mark.parametrize("sizes", EVERY_SIZES)
def test_whitened_products_are_those_of_the_dense_matrix(parts, sizes):
    rng = np.random.default_rng(1)
    a, b = (rng.standard_normal((*parts.force.shape, k)) for k in (2, 3))
    covariance = Covariance(parts, sizes)
    product = covariance.whiten(a).T @ covariance.whiten(b)
    expected = a.reshape(-1, 2).T @ np.linalg.solve(dense(parts, sizes), b.reshape(-1, 3))
    np.testing.assert_allclose(product, expected, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(product, covariance.inner(a, b), rtol=1e-8, atol=1e-11)


def test_whitened_draws_are_white(parts):
    """Data drawn from Σ come out independent, of unit variance."""
    drawn = np.stack([draw(parts, SIZES, seed) for seed in range(8)], axis=2)
    white = Covariance(parts, SIZES).whiten(drawn)
    assert np.mean(white**2) == pytest.approx(1.0, abs=0.05)


def test_rate_is_the_time_derivative(parts):
    loops = campaign(FORCES["OC"], noise=5.0)
    phase_step = 2 * np.pi / POINTS
    smooth = covariance_parts(loops, BASIS).force @ BASIS.columns.T
    slope = (np.roll(smooth, -1, axis=1) - np.roll(smooth, 1, axis=1)) / (2 * np.sin(phase_step))
    rate = covariance_parts(loops, BASIS).rate @ BASIS.columns.T
    omega = 2 * np.pi * loops.frequency[:, None]
    # exact for the first harmonic, which is all a spring and a mass have
    first = np.abs(BASIS.order) == 1
    np.testing.assert_allclose(
        BASIS.compress(rate)[:, first],
        BASIS.compress(omega * slope)[:, first],
        rtol=1e-6,
        atol=1e-6,
    )


def test_noise_is_that_of_the_cycle_mean(parts):
    """5 N a point in five cycles: 5/√5 N a point, /√J a coefficient."""
    assert np.median(parts.noise) == pytest.approx(5.0 / np.sqrt(5) / np.sqrt(POINTS), rel=0.1)


def test_copies_of_cycles_are_no_evidence():
    loops = campaign(FORCES["OC"], noise=5.0)
    once = covariance_parts(loops, BASIS).noise
    copied = tuple(np.concatenate([d, d[:3]]) for d in loops.deviations)
    shifted = tuple(d - d.mean(axis=0) for d in copied)
    again = covariance_parts(replace(loops, deviations=shifted), BASIS).noise
    np.testing.assert_allclose(again, once, rtol=1e-9)


@pytest.mark.parametrize("rounding", [0.0, 1e-12])
def test_a_test_of_copies_alone_has_the_noise_of_the_others(rounding):
    """Copies show no scatter, which is no evidence that there is none; nor is their rounding."""
    loops = campaign(FORCES["OC"], noise=5.0)
    once = covariance_parts(loops, BASIS).noise
    rng = np.random.default_rng(4)
    scale = np.sqrt(np.mean(loops.force**2, axis=1))
    still = rounding * scale[3] * rng.standard_normal(loops.deviations[3].shape)
    copied = (*loops.deviations[:3], still, *loops.deviations[4:])
    noise = covariance_parts(replace(loops, deviations=copied), BASIS).noise
    others = np.arange(len(noise)) != 3
    np.testing.assert_allclose(noise[others], once[others], rtol=1e-9)
    assert noise[3] == pytest.approx(scale[3] * np.median((once / scale)[others]))


def test_likelihood_prefers_the_truth_to_noise_alone(parts):
    residual, jacobian = draw(parts, SIZES, 1), jacobian_of(parts)
    truth = restricted_likelihood(Covariance(parts, SIZES), residual, jacobian)
    for wrong in (
        Sizes(gain=1e-5, offset=1e-3, delay=1e-7),
        Sizes(gain=0.02, offset=4.0, delay=3e-4),
        Sizes(gain=0.02, offset=4.0, delay=3e-4, odd=0.3, even=0.1),
    ):
        assert restricted_likelihood(Covariance(parts, wrong), residual, jacobian) < truth - 20


def test_likelihood_does_not_see_the_base_parameters(parts):
    """REML: what the base model's own parameters can absorb changes nothing."""
    residual, jacobian = draw(parts, SIZES, 2), jacobian_of(parts)
    covariance = Covariance(parts, SIZES)
    moved = residual + jacobian @ np.array([0.3, -2.0])
    assert restricted_likelihood(covariance, moved, jacobian) == pytest.approx(
        restricted_likelihood(covariance, residual, jacobian), abs=1e-4
    )


def test_sizes_are_recovered(parts):
    found = fit_sizes(parts, draw(parts, SIZES, 3), jacobian_of(parts)).sizes
    assert found.odd == pytest.approx(SIZES.odd, rel=0.5)
    assert found.even == pytest.approx(SIZES.even, rel=0.6)
    assert found.offset == pytest.approx(SIZES.offset, rel=0.6)


def test_without_discrepancy_little_is_found(parts):
    """A correct base: the structural sizes fall to where they explain nothing."""
    nothing = Sizes(gain=1e-5, offset=1e-3, delay=1e-7)
    found = fit_sizes(parts, draw(parts, nothing, 4), jacobian_of(parts)).sizes
    assert found.odd < 0.002
    assert found.even < 0.002
    assert found.gain < 0.003
