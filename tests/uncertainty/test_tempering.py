"""The power of a likelihood: right where it is right, and where clusters share an error."""

import numpy as np
import pytest

from sysid.uncertainty.tempering import tempering

CLUSTERS, TESTS, POINTS, FREE = 9, 5, 31, 5
CLUSTER = np.repeat(np.arange(CLUSTERS), TESTS)


def jacobian(rng: np.random.Generator) -> np.ndarray:
    """What a parameter does differs from condition to condition more than within one."""
    between = rng.standard_normal((CLUSTERS, 1, POINTS, FREE))
    within = rng.standard_normal((CLUSTERS, TESTS, POINTS, FREE))
    return (between + 0.3 * within).reshape(-1, POINTS, FREE)


def found(J: np.ndarray, error: np.ndarray) -> float:
    """β of a linear model that least squares fitted to such an error."""
    X = J.reshape(-1, J.shape[2])
    H = X.T @ X
    left = (error.ravel() - X @ np.linalg.pinv(H) @ (X.T @ error.ravel())).reshape(error.shape)
    scores, curvatures = np.einsum("lmn,lm->ln", J, left), np.einsum("lmi,lmj->lij", J, J)
    return tempering(scores, curvatures, CLUSTER)


def test_a_right_likelihood_stays_as_it_is():
    """1/β is one in the mean; β itself never exceeds one."""
    rng = np.random.default_rng(0)
    J = jacobian(rng)
    betas = [found(J, rng.standard_normal(J.shape[:2])) for _ in range(300)]
    assert max(betas) <= 1.0
    assert np.mean(1.0 / np.array(betas)) == pytest.approx(1.15, abs=0.15)


@pytest.mark.parametrize("shared", [1.0, 3.0])
def test_an_error_that_a_condition_shares_is_seen_in_full(shared):
    """tr(H⁻¹S)/n of the true scores, which no estimate has made smaller."""
    rng = np.random.default_rng(1)
    J = jacobian(rng)
    wave = J @ rng.standard_normal(FREE)  # the likes of a wrong scale: the model itself
    H = np.einsum("lmi,lmj->ij", J, J)
    told, true = [], []
    for _ in range(400):
        error = shared * rng.standard_normal(CLUSTERS)[CLUSTER][:, None] * wave
        error = error + rng.standard_normal(J.shape[:2])
        told.append(1.0 / found(J, error))
        scores = np.einsum("lmn,lm->ln", J, error)
        summed = np.stack([scores[c == CLUSTER].sum(axis=0) for c in range(CLUSTERS)])
        true.append(np.trace(np.linalg.solve(H, summed.T @ summed)) / FREE)
    assert np.mean(told) / np.mean(true) == pytest.approx(1.0, abs=0.15)


def test_a_direction_that_one_cluster_alone_sees_counts_as_right():
    rng = np.random.default_rng(2)
    J = jacobian(rng)
    J[CLUSTER != 0, :, 0] = 0.0
    betas = [found(J, rng.standard_normal(J.shape[:2])) for _ in range(100)]
    assert 0.7 < np.mean(betas) <= 1.0


def test_parameters_of_which_nothing_is_seen_do_not_count():
    rng = np.random.default_rng(3)
    J = jacobian(rng)
    error = 2.0 * rng.standard_normal(J.shape[:2])
    blind = J.copy()
    blind[:, :, -1] = 0.0
    assert found(blind, error) == pytest.approx(found(J[:, :, :-1], error), rel=1e-9)
