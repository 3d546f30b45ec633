"""The implicit steps on equations that have a closed form."""

import jax
import jax.numpy as jnp
import numpy as np

from sysid.rig.physical.solver import integrate, solve_linear


def _stiff(y, drive):
    """y_1' = −10⁶ (y_1 − y_2), y_2' = −y_2 in tests with rates of their own, d(y_1³ + y_1)."""
    held = jnp.stack([y[0] ** 3 + y[0], y[1]])
    rate = jnp.stack([-1e6 * (y[0] - y[1]), -drive[0] * y[1]])
    return held, rate


def _last(steps: int) -> np.ndarray:
    rates = np.array([1.0, 2.0])
    h = jnp.full((steps, 2), 1.0 / steps)
    drive = jnp.broadcast_to(jnp.asarray(rates), (steps, 1, 2))
    ys, counts, worst = jax.jit(lambda *a: integrate(_stiff, *a))(
        jnp.ones((2, 2)), (drive, drive), h
    )
    assert float(worst) <= 1e-7
    assert int(counts.max()) < 20
    return np.asarray(ys[-1])


def test_second_order_and_no_trace_of_what_is_too_fast_to_follow():
    exact = np.exp(-np.array([1.0, 2.0]))
    errors = []
    for steps in (20, 40):
        end = _last(steps)
        np.testing.assert_allclose(end[0], end[1], atol=1e-5)
        errors.append(np.abs(end[1] - exact))
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)
    assert errors[1].max() < 1e-4


def test_elimination_against_a_library():
    rng = np.random.default_rng(7)
    matrix = rng.normal(size=(13, 13, 5)) + 8.0 * np.eye(13)[..., None]
    right = rng.normal(size=(13, 5))
    expected = np.linalg.solve(matrix.transpose(2, 0, 1), right.T[..., None])[..., 0].T
    got = solve_linear(jnp.asarray(matrix), jnp.asarray(right))
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)


def test_a_step_that_cannot_be_solved_is_told():
    """U = y², U' = −1: beyond U = 0 there is no y."""
    drive = jnp.zeros((2, 1, 1))
    _, _, worst = integrate(
        lambda y, d: (y**2, 0.0 * y - 1.0), jnp.ones((1, 1)), (drive, drive), jnp.ones((2, 1))
    )
    assert not float(worst) <= 1e-7
