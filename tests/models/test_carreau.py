"""The Carreau–Yasuda model: limits of its laws in speed and in current, and its two parts."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.models.field_law import field_share
from sysid.motion.motion import sine_motion
from tests.models.rival_examples import example

LOOPS = sine_motion(0.0125, 2.0, np.array([0.0, 0.1, 0.4]), points=72)
PLAIN = {"c_a": 0.0, "c_b": 0.0, "k": 0.0, "f_0": 0.0, "h_a": 0.0, "h_b": 0.0}


def test_a_sharp_law_is_bingham_s_and_a_root_is_a_root():
    v, alpha = np.asarray(LOOPS.velocity)[0], 150.0
    sharp = np.asarray(example("carreau", **PLAIN, n=60.0, v_0=0.03).force(LOOPS))[0]
    np.testing.assert_allclose(sharp, alpha * np.clip(v / 0.03, -1.0, 1.0), atol=0.02 * alpha)
    root = np.asarray(example("carreau", **PLAIN, n=2.0, v_0=0.03).force(LOOPS))[0]
    np.testing.assert_allclose(root, alpha * v / np.hypot(v, 0.03), atol=1e-6 * alpha)


def test_a_small_exponent_needs_decades_of_speed():
    """(1 + s^n)^{−1/n} at s = 1 is 2^{−1/n}: of n = ½ a quarter of the plateau, of 8 nearly all."""
    at_v_0 = sine_motion(0.01 / (2 * np.pi), 1.0, 0.0, points=72)
    shares = [
        float(jnp.max(example("carreau", **PLAIN, n=n, v_0=0.01).force(at_v_0))) / 150.0
        for n in (0.5, 1.0, 8.0)
    ]
    assert shares == pytest.approx([0.25, 0.5, 2.0**-0.125], rel=1e-6)


@pytest.mark.parametrize("order", [0.5, 1.0, 1.5, 3.0])
def test_the_law_in_current_is_a_power_that_saturates(order):
    share = jax.jit(lambda i: field_share(i, jnp.asarray(0.5), jnp.asarray(order)))
    low, double = (float(share(jnp.asarray(z))) for z in (1e-4, 2e-4))
    assert np.log2(double / low) == pytest.approx(order, abs=0.02)
    assert float(share(jnp.asarray(-0.5))) == pytest.approx(-np.expm1(-1.0)), "even; 63 % at i_s"
    assert float(share(jnp.asarray(0.0))) == pytest.approx(0.0, abs=1e-6)
    assert float(share(jnp.asarray(500.0))) == pytest.approx(1.0)
    assert np.isfinite(float(jax.grad(share)(jnp.asarray(0.0))))


def test_the_viscous_part_and_the_gas_are_all_that_the_yield_force_leaves():
    valve = example("carreau")
    parts, gas = valve.parts(LOOPS), valve.gas_force(LOOPS)
    np.testing.assert_allclose(parts.total + gas, valve.force(LOOPS), atol=1e-9)
    without = example("carreau", alpha_a=0.0, alpha_b=0.0)
    np.testing.assert_allclose(parts.viscous + gas, without.force(LOOPS), atol=1e-9)
    viscosity = 600.0 + 1500.0 * -np.expm1(-((0.4 / 0.3) ** 1.5))
    v, x = np.asarray(LOOPS.velocity)[2], np.asarray(LOOPS.displacement)[2]
    np.testing.assert_allclose(parts.viscous[2], viscosity * v, rtol=1e-9)
    np.testing.assert_allclose(gas[2], 400.0 * x + 40.0, rtol=1e-9)


def test_the_shift_moves_both_branches_by_h():
    """Force without viscosity passes zero at h where the piston speeds up, at −h where it slows."""
    valve = example("carreau", **(PLAIN | {"h_a": 0.02}))
    v = np.asarray(LOOPS.velocity)[0]
    sign = np.asarray(LOOPS.acceleration_sign)[0]
    force = np.asarray(valve.force(LOOPS))[0]
    assert (np.sign(force) == np.sign(v - 0.02 * sign)).all()
