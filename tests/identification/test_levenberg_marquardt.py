"""The solver: same cost and same minimum as a textbook solver, whatever the blocks."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import least_squares

from sysid.identification.levenberg_marquardt import descend, gram, residuals
from sysid.identification.multistart import in_blocks
from sysid.identification.problem import loop_problem
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build
from tests.identification.campaigns import FIVE_CURRENTS, LOW_DESIGN, virtual_loops


@pytest.fixture(scope="module")
def setting():
    problem = loop_problem(virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.02))
    coordinates = GeneralizedCoordinates(problem.reference, "symmetric")
    truth = np.asarray(coordinates.locate(build(Generalized, LOW_SYMMETRIC)))
    return problem, coordinates, truth


def scaled_residuals(coordinates, problem, u):
    scale = np.sqrt(np.sum(np.asarray(problem.force) ** 2))
    return np.asarray(residuals(coordinates, problem, jnp.asarray(u))).ravel() / scale


@pytest.mark.parametrize("size", [20, 7, 3, 1])
def test_gram_matrix_does_not_depend_on_the_blocks(setting, size):
    problem, coordinates, truth = setting
    blocks = in_blocks(problem, size)
    found = np.asarray(gram(coordinates, (blocks,), jnp.asarray(truth + 0.1)))
    one = np.asarray(gram(coordinates, (in_blocks(problem, 64),), jnp.asarray(truth + 0.1)))
    np.testing.assert_allclose(found, one, rtol=1e-10, atol=1e-14)
    r = scaled_residuals(coordinates, problem, truth + 0.1)
    assert found[-1, -1] == pytest.approx(r @ r, rel=1e-12)


def test_filling_up_a_block_adds_nothing(setting):
    problem, _, _ = setting
    blocks = in_blocks(problem, 7)
    assert blocks.force.shape == (3, 7, 360)
    assert np.count_nonzero(np.asarray(blocks.weight)) == problem.force.size


def test_ends_where_minpack_ends(setting):
    problem, coordinates, truth = setting
    start = truth + 0.2 * np.random.default_rng(1).standard_normal(truth.size)
    peer = least_squares(
        lambda u: scaled_residuals(coordinates, problem, u), start, method="lm", xtol=1e-12
    )
    end = eqx.filter_jit(descend)(
        coordinates, (in_blocks(problem, 64),), jnp.asarray(start), tolerance=1e-10, max_steps=200
    )
    assert bool(end.converged)
    assert float(end.cost) == pytest.approx(2 * peer.cost, rel=1e-6)


def test_out_of_steps_is_said(setting):
    problem, coordinates, truth = setting
    end = eqx.filter_jit(descend)(
        coordinates,
        (in_blocks(problem, 64),),
        jnp.asarray(truth + 1.0),
        tolerance=1e-10,
        max_steps=3,
    )
    assert not bool(end.converged)
    assert int(end.steps) == 3
