"""Values of the fit whose free run errs least have the intervals of that fit, not of another."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.free_run_values import BY_RESIDUAL, UNDER_ERRORS, free_run_values
from sysid.diagnosis.plain import NONE, plainly_fitted, unweighted
from sysid.diagnosis.quantities import free_values
from sysid.likelihood.discrepancy import Covariance

DRAWS = 3000


@pytest.fixture(scope="module")
def free(evidence, spring_state):
    return plainly_fitted(unweighted(evidence), spring_state.coordinates, spring_state.u)


def test_deviations_are_those_of_least_squares_on_drawn_errors(evidence, free):
    """Noise, gains and offsets are drawn test by test; each draw is fitted to first order."""
    sizes = replace(NONE, gain=0.01, offset=5.0)
    values, words = free_run_values(free, evidence, sizes)
    assert words == UNDER_ERRORS
    rng = np.random.default_rng(3)
    parts, J = evidence.parts, free.gls.jacobian
    tests, m, n = J.shape
    error = parts.noise[:, None] * rng.standard_normal((DRAWS, tests, m))
    error += 0.01 * rng.standard_normal((DRAWS, tests, 1)) * parts.force
    error[:, :, 0] += 5.0 * rng.standard_normal((DRAWS, tests))
    peak = evidence.peak[:, None]
    A = (J / peak[:, :, None]).reshape(-1, n)
    drawn = np.linalg.lstsq(A, (error / peak).reshape(DRAWS, -1).T, rcond=None)[0].T
    inside = np.linalg.pinv(free_slopes(free))
    expected = np.sqrt(np.diagonal(inside @ values.covariance @ inside.T))
    np.testing.assert_allclose(drawn.std(axis=0), expected, rtol=4.0 / np.sqrt(2 * DRAWS))


def free_slopes(state):
    """dθ/du, by differences."""
    import jax
    import jax.numpy as jnp

    from sysid.diagnosis.quantities import free_vector

    return np.asarray(jax.jacfwd(lambda u: free_vector(state.coordinates, u))(jnp.asarray(state.u)))


def test_no_value_is_known_better_than_under_sigma(evidence, spring_state, free):
    """Gauss and Markov: the fit under Σ errs least, so its intervals are not those of another."""
    sizes = spring_state.sizes
    covariance = Covariance(evidence.parts, sizes)
    J = free.gls.jacobian
    best = replace(free, gls=replace(free.gls, information=covariance.inner(J, J)))
    values, _ = free_run_values(free, evidence, sizes)
    ratio = np.sqrt(np.diagonal(values.covariance) / np.diagonal(free_values(best).covariance))
    assert (ratio > 1.0 - 1e-6).all()
    assert ratio.max() > 1.3


def test_without_errors_of_the_rig_the_residual_is_the_error(evidence, free):
    values, words = free_run_values(free, evidence, NONE)
    assert words == BY_RESIDUAL
    np.testing.assert_allclose(values.covariance, free_values(free).covariance)


def test_what_no_test_says_anything_of_is_open(evidence, spring_state):
    """A parameter without any effect is not told as if it were held fixed."""
    place = list(spring_state.coordinates.free).index("gas_spring.k_g")
    J = spring_state.gls.jacobian.copy()
    J[:, :, place] = 0.0
    gls = replace(spring_state.gls, jacobian=J,
                  information=spring_state.covariance.inner(J, J))  # fmt: skip
    blind = replace(spring_state, gls=gls)
    for values in (free_values(blind), free_run_values(blind, evidence, spring_state.sizes)[0]):
        sd = np.sqrt(np.diagonal(values.covariance))
        assert sd[place] > 100.0 * abs(values.values[place])
        others = np.delete(sd / np.abs(values.values), place)
        assert np.median(others) < 0.1
