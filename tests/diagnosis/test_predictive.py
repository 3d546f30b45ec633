"""Log predictive densities of conditions: exact, and right about an effect that is there or not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from sysid.diagnosis.predictive import log_densities, renewed


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
    before, after = (log_densities(evidence, s) for s in (base_state, spring_state))
    assert (after - before).sum() > 50.0
    assert renewed(before, after) > 2.5


def test_no_gain_without_a_difference():
    some = np.array([1.0, -2.0, 3.0])
    assert renewed(some, some) == 0.0
    assert abs(renewed(some, some + np.array([1.0, -1.0, 0.0]))) < 1e-12


def test_a_parameter_that_one_condition_alone_shows_is_no_obstacle(evidence, base_state):
    """Nothing predicts it there; all other conditions are predicted as before."""
    own = np.zeros((*base_state.gls.residual.shape, 1))
    first = np.flatnonzero(evidence.condition == np.unique(evidence.condition)[0])
    own[first[0], 3, 0] = 1.0
    jacobian = np.concatenate([base_state.gls.jacobian, own], axis=2)
    gls = replace(
        base_state.gls,
        u=np.append(base_state.u, 0.0),
        jacobian=jacobian,
        information=np.eye(jacobian.shape[2]),
    )
    state = replace(base_state, gls=gls)
    before, after = (log_densities(evidence, s) for s in (base_state, state))
    assert np.isfinite(after).all()
    assert after[0] < before[0]
    np.testing.assert_allclose(after[1:], before[1:], atol=1.0)
