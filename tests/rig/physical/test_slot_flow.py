"""Flow through the valve's gap against closed forms."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import quad

from sysid.rig.physical.slot_flow import power_law_stress, slot_flow

WIDTH, GAP, LENGTH = 0.1, 1e-3, 0.02
AREA = WIDTH * GAP**2


def _flow(drop, yield_stress, consistency, exponent):
    wall = np.asarray(0.5 * np.asarray(drop) * GAP / LENGTH)
    return np.asarray(
        slot_flow(*(jnp.asarray(x) for x in (wall, yield_stress, consistency, exponent, AREA)))
    )


def test_a_newtonian_fluid_follows_the_cubic_law_of_the_gap():
    drop = np.array([-3e5, 2e4, 4e5])
    expected = drop * WIDTH * GAP**3 / (12.0 * 0.1 * LENGTH)
    np.testing.assert_allclose(_flow(drop, 0.0, 0.1, 1.0), expected, rtol=1e-13)


def test_binghams_fluid_follows_the_cubic_of_the_plug():
    """Q/Q_N = 1 − 3/2 φ + 1/2 φ³ with φ = τ_y/τ_w."""
    tau_y, drop = 1.5e4, np.array([7e5, 1e6, 5e6])
    phi = tau_y / (0.5 * drop * GAP / LENGTH)
    newton = drop * WIDTH * GAP**3 / (12.0 * 0.1 * LENGTH)
    expected = newton * (1.0 - 1.5 * phi + 0.5 * phi**3)
    np.testing.assert_allclose(_flow(drop, tau_y, 0.1, 1.0), expected, rtol=1e-12)


def test_below_the_yield_stress_nothing_flows():
    limit = 2.0 * 1.5e4 * LENGTH / GAP
    assert _flow(0.999 * limit, 1.5e4, 0.1, 0.8) == 0.0
    assert _flow(1.001 * limit, 1.5e4, 0.1, 0.8) > 0.0


def test_herschel_and_bulkley_against_the_integral_of_the_shear_rate():
    tau_y, k, n, wall = 9e3, 0.25, 0.8, 1.7e4
    integral, _ = quad(lambda t: t * ((t - tau_y) / k) ** (1.0 / n), tau_y, wall, epsrel=1e-13)
    expected = 2.0 * WIDTH * (0.5 * GAP / wall) ** 2 * integral
    assert _flow(2.0 * wall * LENGTH / GAP, tau_y, k, n) == pytest.approx(expected, rel=1e-11)


def test_the_inverse_without_yield_stress():
    wall = jnp.asarray([-2e3, 40.0, 9e3])
    flow = slot_flow(wall, *(jnp.asarray(x) for x in (0.0, 0.25, 0.8, AREA)))
    back = power_law_stress(flow, *(jnp.asarray(x) for x in (0.25, 0.8, AREA, 0.0)))
    np.testing.assert_allclose(back, wall, rtol=1e-12)


def test_the_dampers_annulus_is_as_good_as_a_slot():
    """Newtonian flow through an annulus (Lamb) and through the slot of its mean circumference."""
    inner, outer = 18.1e-3, 18.9e-3
    ratio = outer / inner
    annulus = np.pi / 8.0 * (outer**4 - inner**4 - (outer**2 - inner**2) ** 2 / np.log(ratio))
    slot = np.pi * (inner + outer) * (outer - inner) ** 3 / 12.0
    assert slot / annulus == pytest.approx(1.0, abs=1e-3)
