"""The normal equations of loops' seven numbers are those of the model's own Jacobian."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.fleet.normal_equations import normal_equations
from sysid.fleet.stack import stack_loops, thinned
from sysid.identification.levenberg_marquardt import residuals
from sysid.identification.problem import loop_problem
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from tests.fleet.dampers import TESTS, damper


@eqx.filter_jit
def linearised(coordinates, problem, u):
    """The Jacobian of all points by all coordinates, and the residuals, over √Σ w² F²."""
    scale = jnp.sqrt(jnp.sum((problem.weight * problem.force) ** 2))

    def r(z):
        return residuals(coordinates, problem, z).ravel() / scale

    return jax.jacfwd(r)(u), r(u)


def test_gram_matrix_gradient_and_cost_are_those_of_the_model():
    fleet = [damper(0), damper(1, tests=TESTS[:7])]  # the second is filled up to as many tests
    stack = stack_loops(fleet, "peak")
    problems = [loop_problem(loops, "peak") for loops in fleet]
    maps = [GeneralizedCoordinates(p.reference, "symmetric") for p in problems]
    u = 0.5 * np.random.default_rng(2).standard_normal((2, maps[0].size))
    found = jax.jit(normal_equations, static_argnums=0)("symmetric", stack, jnp.asarray(u))
    jacobian, rest = linearised(maps[1], problems[1], jnp.asarray(u[1]))
    scale = float(jnp.abs(jacobian.T @ jacobian).max())
    assert found.cost[1] == pytest.approx(float(rest @ rest), rel=1e-10)
    assert np.allclose(found.gradient[1], jacobian.T @ rest, rtol=1e-9, atol=1e-10 * scale)
    assert np.allclose(found.matrix[1], jacobian.T @ jacobian, rtol=1e-9, atol=1e-10 * scale)


def test_thinned_loops_keep_the_size_of_the_cost():
    stack = stack_loops([damper(0)])
    part = thinned(stack, 24)
    assert part.points == 24
    assert np.sum(stack.force**2) == pytest.approx(1.0)
    assert np.sum(part.force**2) == pytest.approx(1.0, rel=0.01)
    assert thinned(stack, 50) is stack, "no divisor of 72 leaves 50 points or more but 72"
