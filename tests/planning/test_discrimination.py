"""How surely a test tells explanations apart: against brute force, and where nothing can."""

import numpy as np
import pytest
from scipy.optimize import minimize

from sysid.likelihood.discrepancy import Sizes
from sysid.planning.candidates import Candidate
from sysid.planning.discrimination import BASIS, Seen, errors_of, predict, weigh
from tests.planning.asked import NOISE, SIZES, alternative

TEST = Candidate("sine", 0.01, 3.0, 0.2)
FREQUENCY = np.array([3.0])


def seen(rng: np.random.Generator, k: int = 3) -> Seen:
    m = BASIS.order.size
    return Seen(
        np.zeros((1, 360)),
        100.0 * rng.standard_normal((1, m)),
        30.0 * rng.standard_normal((1, m, k)),
        10.0 * rng.standard_normal((1, m, 4)),
    )


def distance(right, other, covariance, sizes=SIZES):
    """Δ of the one test."""
    (found,) = weigh(right, other, covariance, sizes, NOISE, FREQUENCY).distance()
    return found


def test_distance_is_the_least_misfit_of_the_rival_fitted_again():
    """min over δ of ‖d − Jδ‖² under Σ plus δᵀC⁻¹δ, found by a minimiser that knows no formula."""
    rng = np.random.default_rng(1)
    right, other = seen(rng), seen(rng)
    root = rng.standard_normal((3, 3))
    C = root @ root.T
    sigma = errors_of(other, SIZES, NOISE, FREQUENCY, np.array([True]))
    weight = sigma.weighted(np.eye(BASIS.order.size)[None])[0]
    d, J = (right.harmonics - other.harmonics)[0], other.slopes[0]

    def misfit(delta):
        left = d - J @ delta
        return left @ weight @ left + delta @ np.linalg.solve(C, delta)

    least = minimize(misfit, np.zeros(3), tol=1e-12).fun
    assert distance(right, other, C) == pytest.approx(least, rel=1e-6)


def test_parameters_that_the_old_tests_do_not_know_explain_whatever_they_can():
    """A difference along a column of J is worth nothing if that parameter is unknown."""
    rng = np.random.default_rng(2)
    other = seen(rng)
    along = other.harmonics + other.slopes[:, :, 0]
    right = Seen(other.force, along, other.slopes, other.laws)
    known, unknown = (distance(right, other, np.diag([v, 1e-12, 1e-12])) for v in (1e-12, 1e12))
    assert known > 100.0
    assert unknown < 1e-3 * known


def test_errors_of_the_rig_hide_what_looks_like_them():
    """A gain of 1 % is seen where the rig's gain is sure, and not where it is not."""
    rng = np.random.default_rng(3)
    other = seen(rng, 1)
    right = Seen(other.force, 1.01 * other.harmonics, other.slopes, other.laws)
    sure, unsure = (
        distance(right, other, np.zeros((0, 0)), Sizes(gain=g, offset=0.0, delay=0.0))
        for g in (1e-6, 0.01)
    )
    assert sure == pytest.approx(np.sum((0.01 * other.harmonics) ** 2) / NOISE**2, rel=1e-3)
    assert unsure == pytest.approx(1.0, rel=0.01)


def test_a_model_that_is_not_finite_tells_nothing():
    rng = np.random.default_rng(4)
    right, other = seen(rng), seen(rng)
    right.harmonics[0, 3] = np.nan
    assert distance(right, other, np.eye(3)) == 0.0


@pytest.mark.parametrize("kind", ["sine", "triangle", "current_step", "rod_disconnected"])
def test_slopes_are_those_of_the_force(kind):
    """Against finite differences of the size of a spring, which nothing else knows of."""
    test = Candidate(kind, 0.01, 3.0, 0.2)
    one, more = alternative("fixture_inertia", 1.0), alternative("fixture_inertia", 1.001)
    low, high = (predict(z, [test], 40.0) for z in (one, more))
    assert low.slopes.shape == (1, BASIS.order.size, 5)
    change = (high.harmonics - low.harmonics) / 0.001
    np.testing.assert_allclose(low.slopes[..., -1], change, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(BASIS.compress(low.force), low.harmonics, atol=1e-9)


def test_a_rig_without_a_damper_feels_its_own_mass_and_no_spring():
    """F = −m ω² A sin ωt, and nothing at all."""
    test = Candidate("rod_disconnected", 0.002, 10.0, 0.0)
    mass, spring = (
        predict(alternative(id), [test], 40.0) for id in ("fixture_inertia", "gas_spring")
    )
    phase = 2 * np.pi * np.arange(360) / 360
    expected = -1.0 * (20 * np.pi) ** 2 * 0.002 * np.sin(phase)
    np.testing.assert_allclose(mass.force[0], expected, atol=1e-9)
    assert not spring.force.any()
    assert not spring.laws.any()
