"""Log predictive densities of conditions: exact, and right about an effect that is there or not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from sysid.diagnosis.predictive import density_gains, log_densities, renewed


def test_densities_are_those_of_the_dense_matrices(evidence, base_state):
    """Condition by condition: GLS on the others, then the conditional Gaussian."""
    shape = base_state.gls.residual.shape
    unit = np.eye(shape[0] * shape[1]).reshape(*shape, -1)
    inverse = base_state.covariance.inner(unit, unit)
    sigma = np.linalg.inv(inverse)
    J = base_state.gls.jacobian.reshape(sigma.shape[0], -1)
    J = np.linalg.svd(J / np.linalg.norm(J, axis=0), full_matrices=False)[0]
    r = base_state.gls.residual.ravel()
    found = log_densities(evidence, base_state)
    for k, number in enumerate(np.unique(evidence.condition)[:3]):
        out = np.repeat(evidence.condition == number, shape[1])
        S, C, V = (sigma[np.ix_(a, b)] for a, b in ((~out, ~out), (out, ~out), (out, out)))
        information = J[~out].T @ np.linalg.solve(S, J[~out])
        beta = np.linalg.solve(information, J[~out].T @ np.linalg.solve(S, r[~out]))
        to = np.linalg.solve(S, C.T).T
        mean = J[out] @ beta + to @ (r[~out] - J[~out] @ beta)
        reach = J[out] - to @ J[~out]
        spread = V - to @ C.T + reach @ np.linalg.solve(information, reach.T)
        expected = multivariate_normal(mean, 0.5 * (spread + spread.T)).logpdf(r[out])
        assert found[k] == pytest.approx(expected, rel=1e-4, abs=0.05)


def test_a_true_effect_is_renewed_by_every_condition(evidence, base_state, spring_state):
    gains = density_gains(evidence, base_state, spring_state)
    before, after = (log_densities(evidence, s) for s in (base_state, spring_state))
    np.testing.assert_allclose(gains, after - before, atol=1e-6)
    assert gains.sum() > 50.0
    assert renewed(gains) > 2.5


def test_no_gain_without_a_difference():
    assert renewed(np.zeros(3)) == 0.0
    assert abs(renewed(np.array([1.0, -1.0, 0.0]))) < 1e-12


@pytest.mark.parametrize("error", [0.0, 8.0, 40.0])
def test_what_one_condition_alone_shows_is_confirmed_by_none(evidence, base_state, error):
    """A parameter that bends one test only, and takes up an error there of so many deviations.

    The error itself would be evidence: ½·error².  No other condition predicts it.
    """
    own = np.zeros((*base_state.gls.residual.shape, 1))
    first = np.flatnonzero(evidence.condition == np.unique(evidence.condition)[0])
    own[first[0], 3, 0] = 1.0
    deviation = 1.0 / np.sqrt(base_state.covariance.inner(own, own)[0, 0])
    wrong = replace(
        base_state.gls, residual=base_state.gls.residual + error * deviation * own[:, :, 0]
    )
    jacobian = np.concatenate([base_state.gls.jacobian, own], axis=2)
    right = replace(
        base_state.gls,
        u=np.append(base_state.u, 0.0),
        jacobian=jacobian,
        information=np.eye(jacobian.shape[2]),
    )
    before, after = (replace(base_state, gls=gls) for gls in (wrong, right))
    gains = density_gains(evidence, before, after)
    assert abs(gains[0]) < 1e-4
    # the error, and the noise there, of one deviation itself, had drawn the base a little, and
    # with it what is predicted elsewhere
    assert abs(gains[1:].sum()) < 0.1 * 0.5 * (error**2 + 1.0)
