"""First-order recurrences: solutions of a plain loop, and derivatives of differences and of a scan
that JAX derives by itself."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.first_order import first_order

N = 24
RNG = np.random.default_rng(0)


def scanned(kept, drive, start, *, periodic):
    """The same by a scan that knows nothing of its derivative: a cycle is run from its own end."""

    def run(begin):
        def step(past, now):
            new = now[0] * past + now[1]
            return new, new

        rows = (jnp.moveaxis(z, -1, 0) for z in jnp.broadcast_arrays(kept, drive))
        return jnp.moveaxis(jax.lax.scan(step, begin, tuple(rows))[1], 0, -1)

    whole = jnp.broadcast_shapes(kept.shape, drive.shape)[:-1]
    zero = jnp.zeros(whole, drive.dtype)
    if not periodic:
        return run(zero + start)
    return run(run(zero)[..., -1] / (1.0 - jnp.prod(kept, axis=-1)))


def draws(shape, *, turning):
    """α inside the unit circle, b and y_{−1}."""
    kept = RNG.uniform(0.2, 1.0, shape)
    drive, start = RNG.standard_normal(shape), RNG.standard_normal(shape[:-1])
    if turning:
        kept = kept * np.exp(1j * RNG.uniform(-1.0, 1.0, shape))
        drive = drive + 1j * RNG.standard_normal(shape)
        start = start + 1j * RNG.standard_normal(shape[:-1])
    return tuple(map(jnp.asarray, (kept, drive, start)))


CASES = [
    pytest.param((N,), True, False, id="periodic"),
    pytest.param((N,), False, False, id="from a start"),
    pytest.param((3, 2, N), True, False, id="periodic, batched"),
    pytest.param((3, 2, N), False, False, id="from a start, batched"),
    pytest.param((3, N), False, True, id="from a start, complex"),
]


@pytest.mark.parametrize(("shape", "periodic", "turning"), CASES)
def test_value_and_change_are_those_of_a_plain_scan(shape, periodic, turning):
    at, along = draws(shape, turning=turning), draws(shape, turning=turning)

    def ours(kept, drive, start):
        return first_order(kept, drive, periodic=periodic, start=start)

    def plain(kept, drive, start):
        return scanned(kept, drive, start, periodic=periodic)

    found, change = jax.jit(lambda a, b: jax.jvp(ours, a, b))(at, along)
    expected, slope = jax.jvp(plain, at, along)
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(change, slope, rtol=1e-10, atol=1e-11)
    up, down = (ours(*(a + s * b for a, b in zip(at, along, strict=True))) for s in (1e-6, -1e-6))
    np.testing.assert_allclose(change, (up - down) / 2e-6, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("periodic", [True, False])
def test_jacobians_forward_and_backward_and_second_derivatives(periodic):
    kept, drive, start = draws((2, N), turning=False)

    def total(by, z):
        y = by(kept * jnp.tanh(z[0]), z[1] * drive, start * z[2], periodic=periodic)
        return jnp.sum(y**2 * jnp.cos(drive))

    def ours(z):
        return total(lambda a, b, s, periodic: first_order(a, b, periodic=periodic, start=s), z)

    def plain(z):
        return total(scanned, z)

    z = jnp.array([0.9, 1.3, 0.7])
    expected = jax.grad(plain)(z)
    np.testing.assert_allclose(jax.jit(jax.jacfwd(ours))(z), expected, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(jax.jit(jax.grad(ours))(z), expected, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(jax.linearize(ours, z)[1](z), expected @ z, rtol=1e-10)
    np.testing.assert_allclose(jax.hessian(ours)(z), jax.hessian(plain)(z), rtol=1e-9, atol=1e-10)


def test_where_nothing_moves_the_sum_remains_and_derivatives_are_finite():
    """All α are 1 on a cycle: y = Σb, as if from rest; its changes are those of that sum."""
    kept, drive = jnp.ones(N), jnp.asarray(RNG.standard_normal(N))
    along = draws((N,), turning=False)[:2]
    found, change = jax.jvp(lambda a, b: first_order(a, b, periodic=True), (kept, drive), along)
    expected, slope = jax.jvp(lambda a, b: scanned(a, b, 0.0, periodic=False), (kept, drive), along)
    np.testing.assert_allclose(found, jnp.cumsum(drive), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(change, slope, rtol=1e-12, atol=1e-12)
