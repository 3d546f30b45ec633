"""Generalised least squares: exact optima, honest covariances, and less scatter than ordinary least
squares where the errors are correlated."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import NonlinearConstraint, least_squares, minimize

from sysid.identification.problem import loop_problem
from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import Covariance, Sizes, covariance_parts
from sysid.likelihood.gls import AT_BOUND, Bound, gauss_newton
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from tests.diagnosis.test_lack_of_fit import POINTS, campaign
from tests.likelihood.dense import dense

BASIS = harmonic_basis(POINTS)
SIZES = Sizes(gain=0.01, offset=2.0, delay=1e-4, odd=0.04, even=0.01)
TRUTH = np.log([200.0, 1500.0, 0.01, 300.0])


def model(u, loops):
    """(p₀ + p₁ i) tanh(v/p₂) + p₃ v in harmonics, and its derivatives with respect to ln p."""
    p, v, i = np.exp(u), loops.velocity, loops.current[:, None]
    rise, strength = np.tanh(v / p[2]), p[0] + p[1] * i
    slopes = [p[0] * rise, p[1] * i * rise, -strength * (1 - rise**2) * v / p[2], p[3] * v]
    force = strength * rise + p[3] * v
    return BASIS.compress(force), np.stack([BASIS.compress(s) for s in slopes], axis=2)


@pytest.fixture(scope="module")
def toy():
    """Loops, Σ, its root, and evaluate for given errors [L, m]."""
    p = np.exp(TRUTH)
    loops = campaign(
        lambda x, v, a, A, f, i: (p[0] + p[1] * i) * np.tanh(v / p[2]) + p[3] * v, noise=5.0
    )
    parts = covariance_parts(loops, BASIS)

    def measured(errors):
        target = model(TRUTH, loops)[0] + errors

        def evaluate(u):
            force, jacobian = model(u, loops)
            return target - force, jacobian

        return evaluate

    return parts, measured


def draws(parts, count):
    root = np.linalg.cholesky(dense(parts, SIZES))
    random = np.random.default_rng(0)
    return [
        (root @ random.standard_normal(root.shape[0])).reshape(parts.force.shape)
        for _ in range(count)
    ]


START = TRUTH + np.array([0.5, -0.5, 0.7, -0.6])


def test_optimum_is_that_of_the_dense_whitened_problem(toy):
    parts, measured = toy
    evaluate, covariance = measured(draws(parts, 1)[0]), Covariance(parts, SIZES)
    found = gauss_newton(evaluate, START, covariance)
    assert found.converged
    white = np.linalg.inv(np.linalg.cholesky(dense(parts, SIZES)))
    other = least_squares(
        lambda u: white @ evaluate(u)[0].ravel(),
        TRUTH,
        jac=lambda u: -white @ evaluate(u)[1].reshape(white.shape[0], -1),  # pyright: ignore[reportArgumentType]  # scipy takes a callable
        xtol=1e-12,
        ftol=1e-12,
    )
    errors = np.sqrt(np.diagonal(np.linalg.inv(found.information)))
    np.testing.assert_allclose(found.u, other.x, atol=2e-3 * errors.min())
    assert found.cost == pytest.approx(2.0 * other.cost, rel=1e-8)
    white = covariance.whiten(found.jacobian)
    np.testing.assert_allclose(found.information, white.T @ white, rtol=1e-8)


def test_exact_data_are_fitted_exactly(toy):
    parts, measured = toy
    found = gauss_newton(
        measured(np.zeros_like(parts.force)), START, Covariance(parts, SIZES), tolerance=1e-14
    )
    assert found.converged
    np.testing.assert_allclose(found.u, TRUTH, atol=1e-6)
    assert found.cost < 1e-6


def test_estimates_scatter_as_the_information_says_and_less_than_ordinary_ones(toy):
    """Campaigns with errors drawn from Σ, fitted with Σ and with noise alone."""
    parts, measured = toy
    right = Covariance(parts, SIZES)
    plain = Covariance(parts, Sizes(gain=0.0, offset=0.0, delay=0.0))
    general, ordinary, costs = [], [], []
    for errors in draws(parts, 24):
        fit = gauss_newton(measured(errors), TRUTH, right)
        root = np.linalg.cholesky(fit.information)
        general.append(root.T @ (fit.u - TRUTH))
        costs.append(fit.cost)
        ordinary.append(root.T @ (gauss_newton(measured(errors), TRUTH, plain).u - TRUTH))
    size = parts.force.size - TRUTH.size
    assert np.mean(np.square(general)) == pytest.approx(1.0, abs=0.45)  # 3.1 standard errors
    assert np.mean(costs) == pytest.approx(size, abs=3.1 * np.sqrt(2 * size / 24))
    assert np.mean(np.square(ordinary)) > 2.0 * np.mean(np.square(general))


def test_what_moves_nothing_stays_and_what_is_doubled_does_no_harm(toy):
    """Two columns alike and one of zeros: the same optimum in what is determined."""
    parts, measured = toy
    inner = measured(draws(parts, 1)[0])
    covariance = Covariance(parts, SIZES)

    def evaluate(u):
        residual, jacobian = inner(np.array([u[0] + u[4], *u[1:4]]))
        return residual, np.concatenate(
            [jacobian, jacobian[:, :, :1], np.zeros_like(jacobian[:, :, :1])], axis=2
        )

    found = gauss_newton(evaluate, np.array([*START, 0.0, 7.0]), covariance)
    once = gauss_newton(inner, START, covariance)
    assert found.converged
    assert found.u[5] == 7.0
    assert found.cost == pytest.approx(once.cost, rel=1e-9)
    assert found.u[0] + found.u[4] == pytest.approx(once.u[0], abs=1e-4)


def test_a_prior_pulls_by_its_precision(toy):
    """At the optimum JᵀΣ⁻¹r = Π(u − u₀); a very precise one holds its parameter."""
    parts, measured = toy
    covariance, prior = Covariance(parts, SIZES), np.diag([1e4, 0.0, 0.0, 1e12])
    found = gauss_newton(
        measured(draws(parts, 1)[0]), TRUTH + 0.05, covariance, prior_precision=prior
    )
    assert found.converged
    pull = prior @ (found.u - TRUTH - 0.05)
    downhill = covariance.inner(found.jacobian, found.residual[:, :, None])[:, 0]
    errors = np.sqrt(np.diagonal(np.linalg.inv(found.information + prior)))
    np.testing.assert_allclose((downhill - pull) * errors, 0.0, atol=5e-3)
    assert found.u[3] == pytest.approx(TRUTH[3] + 0.05, abs=1e-5)
    away = found.u - TRUTH - 0.05
    alone = covariance.inner(found.residual[:, :, None], found.residual[:, :, None])[0, 0]
    assert found.cost == pytest.approx(alone + away @ prior @ away, rel=1e-9)


def test_steps_to_where_the_model_is_not_finite_are_refused(toy):
    parts, measured = toy
    inner, covariance = measured(draws(parts, 1)[0]), Covariance(parts, SIZES)

    def evaluate(u):
        residual, jacobian = inner(u)
        return (residual if u[3] > TRUTH[3] - 0.61 else residual * np.nan), jacobian

    best = gauss_newton(inner, START, covariance).cost
    assert gauss_newton(evaluate, START, covariance).cost == pytest.approx(best, rel=1e-6)

    def astronomic(u):
        residual, jacobian = inner(u)
        return residual, (jacobian if u[3] > TRUTH[3] - 0.61 else 1e200 * jacobian)

    assert gauss_newton(astronomic, START, covariance).cost == pytest.approx(best, rel=1e-6)
    with pytest.raises(ValueError, match="not finite where the fit starts"):
        gauss_newton(evaluate, START - 1.0, covariance)


def test_a_bound_that_holds_nothing_changes_nothing(toy):
    parts, measured = toy
    evaluate, covariance = measured(draws(parts, 1)[0]), Covariance(parts, SIZES)
    weight = np.ones(parts.noise.size)
    free = gauss_newton(evaluate, START, covariance)
    start = Bound(weight, 0.0).left(evaluate(START)[0])
    loose = gauss_newton(evaluate, START, covariance, bound=Bound(weight, 2.0 * start))
    np.testing.assert_array_equal(loose.u, free.u)
    assert loose.converged


def test_under_a_bound_the_optimum_is_that_of_a_constrained_solver(toy):
    """Start at ordinary least squares; half of what the optimum under Σ leaves more is allowed."""
    parts, measured = toy
    evaluate, covariance = measured(draws(parts, 1)[0]), Covariance(parts, SIZES)
    weight = parts.noise**-2.0
    plain = Covariance(parts, Sizes(gain=0.0, offset=0.0, delay=0.0))
    start = gauss_newton(evaluate, TRUTH, plain).u
    free = gauss_newton(evaluate, start, covariance)
    left = Bound(weight, 0.0).left
    ends = left(evaluate(start)[0]), left(free.residual)
    bound = Bound(weight, 0.5 * sum(ends))
    assert ends[0] < bound.most < ends[1], "the bound must hold the fit for this test to say much"
    held = gauss_newton(evaluate, start, covariance, bound=bound)
    assert bound.left(held.residual) <= bound.most

    def cost(u):
        r = evaluate(u)[0][:, :, None]
        return float(covariance.inner(r, r)[0, 0])

    scale = cost(start) - free.cost
    other = minimize(
        lambda u: (cost(u) - free.cost) / scale, start, method="trust-constr",
        constraints=NonlinearConstraint(lambda u: left(evaluate(u)[0]) / bound.most, -np.inf, 1.0),
        options={"gtol": 1e-8, "xtol": 1e-10},
    )  # fmt: skip
    least = free.cost + scale * float(other.fun)
    assert cost(start) > least + 20.0 * AT_BOUND > free.cost + 40.0 * AT_BOUND
    assert held.cost == pytest.approx(least, abs=AT_BOUND)


def test_a_start_beyond_the_bound_is_refused(toy):
    parts, measured = toy
    evaluate, covariance = measured(draws(parts, 1)[0]), Covariance(parts, SIZES)
    with pytest.raises(ValueError, match="starts"):
        gauss_newton(evaluate, START, covariance, bound=Bound(np.ones(parts.noise.size), 1.0))


def test_too_few_steps_are_not_called_converged(toy):
    parts, measured = toy
    found = gauss_newton(measured(draws(parts, 1)[0]), START, Covariance(parts, SIZES), max_steps=1)
    assert found.steps == 1
    assert not found.converged


@eqx.filter_jit
def linearised(coordinates, motion, columns, u):
    """Force in harmonics and its derivative with respect to u."""

    def force(z):
        return coordinates.valve(z).force(motion) @ columns

    return force(u), jax.jacfwd(force)(u)


def test_at_a_kink_steps_end_where_they_promise_nothing(toy):
    """The slope turns over at the optimum: every full step promises much and gains nothing."""
    parts, _ = toy
    shape, calls = np.ones_like(parts.force), []

    def bent(u):
        calls.append(float(u[0]))
        slope = 1.0 if u[0] > 0.0 else -3.0
        return shape * (0.05 + slope * u[0]), -slope * shape[:, :, None]

    found = gauss_newton(
        bent, np.array([0.3]), Covariance(parts, SIZES), tolerance=1e-3, max_steps=100
    )
    assert abs(found.u[0]) < 1e-3
    assert len(calls) < 30


def test_generalised_model_on_a_trial_campaign():
    """With laws 3 % wrong the optimum is exact: no direction of any parameter lowers the cost."""
    loops = make_trial(3, design=TrialDesign(fewest=40, most=40, misfit=0.03, points=POINTS)).loops
    problem = loop_problem(loops)
    coordinates = GeneralizedCoordinates(problem.reference, "symmetric")
    columns = jnp.asarray(BASIS.columns / POINTS)
    measured = BASIS.compress(loops.force)

    def evaluate(u):
        force, jacobian = linearised(coordinates, problem.motion, columns, jnp.asarray(u))
        return measured - np.asarray(force), np.asarray(jacobian)

    covariance = Covariance(covariance_parts(loops, BASIS), Sizes(odd=0.02, even=0.005))
    start = np.asarray(coordinates.locate(build(Generalized, LOW_SYMMETRIC)))
    found = gauss_newton(evaluate, start, covariance, max_steps=40)
    assert found.converged
    downhill = covariance.whiten(found.jacobian).T @ covariance.whiten(found.residual[:, :, None])
    # by a standard error, or by one in a coordinate that the campaign does not determine that well
    errors = 1.0 / np.sqrt(np.diagonal(found.information) + 1.0)
    np.testing.assert_allclose(downhill[:, 0] * errors, 0.0, atol=5e-3)
    again = gauss_newton(evaluate, found.u + 0.02, covariance, max_steps=40)
    assert again.cost == pytest.approx(found.cost, abs=1e-3)
