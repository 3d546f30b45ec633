"""The generalised model against published values, symmetries and limits."""

from decimal import Decimal, localcontext

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.models.generalized import (
    ASYMMETRIC,
    HIGH_SYMMETRIC,
    LOW_SYMMETRIC,
    Generalized,
    logistic_rise,
)
from sysid.motion.motion import sine_motion
from sysid.parameters import build, specs, values

TABLES = {"low": LOW_SYMMETRIC, "high": HIGH_SYMMETRIC, "asymmetric": ASYMMETRIC}


def loops(table, amplitude, frequency, currents):
    n = len(currents)
    motion = sine_motion(np.full(n, amplitude), np.full(n, frequency), np.array(currents))
    return motion, np.asarray(build(Generalized, table).force(motion))


@pytest.mark.parametrize(
    ("name", "amplitude", "frequency", "currents", "expected"),
    [
        ("low", 0.0125, 1.5, [0, 0.1, 0.2, 0.3, 0.4], [301, 708, 980, 1137, 1221]),
        ("low", 0.0125, 2.5, [0, 0.1, 0.2, 0.3, 0.4], [389, 914, 1265, 1468, 1576]),
        ("high", 0.0025, 10.0, [0, 0.1, 0.2, 0.3, 0.4], [347, 799, 1196, 1383, 1446]),
        ("asymmetric", 0.0125, 0.5, [0, 0.1, 0.2, 0.3], [192, 244, 234, 208]),
    ],
)
def test_largest_force_is_the_published_one(name, amplitude, frequency, currents, expected):
    _, force = loops(TABLES[name], amplitude, frequency, currents)
    np.testing.assert_allclose(force.max(axis=1), expected, atol=1.0)


def test_smallest_force_of_the_asymmetric_set_is_the_published_one():
    _, force = loops(ASYMMETRIC, 0.0125, 0.5, [0, 0.1, 0.2, 0.3])
    np.testing.assert_allclose(force.min(axis=1), [-230, -470, -667, -809], atol=1.0)


def test_rebound_to_compression_ratio_falls_from_four_to_about_two():
    """W11 §3: of the order of 4 at low speed, about 2 at high; 3.9 to 2.7 by extremes of force."""
    slow = loops(ASYMMETRIC, 0.0125, 0.5, [0.3])[1]
    fast = loops(ASYMMETRIC, 0.025, 1.5, [0.3])[1]
    assert -slow.min() / slow.max() == pytest.approx(3.9, abs=0.05)
    assert -fast.min() / fast.max() == pytest.approx(2.7, abs=0.05)


def test_force_at_rest_is_twice_the_friction_scale():
    """F_t(0) = 2 F_0 = 137 N at 0 A."""
    low = build(Generalized, LOW_SYMMETRIC)
    assert float(low.transition_force(jnp.zeros(()))) == pytest.approx(137.0, abs=0.1)


@pytest.mark.parametrize("name", ["low", "high"])
def test_symmetric_sets_give_half_wave_symmetric_loops(name):
    _, force = loops(TABLES[name], 0.0025, 5.0, [0.0, 0.3])
    np.testing.assert_allclose(np.roll(force, 180, axis=1), -force, atol=1e-9)


@pytest.mark.parametrize("name", TABLES)
def test_the_damper_dissipates_in_every_cycle(name):
    motion, force = loops(TABLES[name], 0.0125, 1.5, [0.0, 0.1, 0.2, 0.3])
    work = (force * np.asarray(motion.velocity)).mean(axis=1)
    assert (work > 0).all()
    assert (np.diff(work) > 0).all()  # more current, more dissipation


def test_force_lags_velocity_for_negative_k_4():
    """Zero force is reached after zero velocity: at v = 0, ẍ < 0 the force is still positive."""
    _, force = loops(LOW_SYMMETRIC, 0.0125, 1.5, [0.2])
    assert force[0, 90] > 0  # φ = 90°: largest displacement, v = 0, deceleration done


def test_mean_variant_has_no_hysteresis():
    _, force = loops({**LOW_SYMMETRIC, "k_4": 0.0}, 0.0125, 1.5, [0.2])
    mirrored = force[0, (180 - np.arange(360)) % 360]  # same velocity on the other branch: φ → −φ
    np.testing.assert_allclose(force[0, (-np.arange(360)) % 360], force[0], atol=1e-9)
    np.testing.assert_allclose(mirrored, -force[0], atol=1e-9)


def test_passive_variant_does_not_feel_current():
    passive = {**LOW_SYMMETRIC, **dict.fromkeys(("k_2", "k_3", "a_2", "a_3", "I_0", "I_1"), 0.0)}
    _, force = loops(passive, 0.0125, 1.5, [0.0, 0.4])
    np.testing.assert_allclose(force[0], force[1], rtol=1e-12)


def test_gain_is_clipped_at_one():
    """C_i ≥ 1 is part of Eq. 5."""
    gain = build(Generalized, LOW_SYMMETRIC).force_gain(jnp.array([-0.3, 0.0, 0.3]))
    np.testing.assert_allclose(gain[:2], 1.0, atol=1e-12)
    assert gain[2] > 3.0


@pytest.mark.parametrize("start", [-600.0, -40.0, -1.0, 0.0, 2.0, 40.0, 600.0])
@pytest.mark.parametrize("step", [1e-12, 1e-3, 1.0, 30.0, 800.0])
def test_logistic_rise_keeps_its_digits(step, start):
    with localcontext(prec=700):
        b, c = Decimal(step), Decimal(start)
        expected = float(1 / (1 + (-b - c).exp()) - 1 / (1 + (-c).exp()))
    assert float(logistic_rise(jnp.array(step), jnp.array(start))) == pytest.approx(
        expected, rel=1e-12, abs=1e-300
    )


@pytest.mark.parametrize("name", TABLES)
def test_gradient_agrees_with_finite_differences(name):
    motion, _ = loops(TABLES[name], 0.0125, 1.5, [0.1, 0.3])
    theta = values(build(Generalized, TABLES[name]))
    weight = np.random.default_rng(0).standard_normal(motion.velocity.shape)

    def functional(z):
        return jnp.sum(weight * build(Generalized, z).force(motion))

    gradient = jax.grad(functional)(theta)
    for k, spec in enumerate(specs(Generalized)):
        if float(theta[k]) == spec.low:
            continue  # one-sided there
        h = 1e-6 * max(abs(float(theta[k])), 1e-2)
        step = jnp.zeros(16).at[k].set(h)
        difference = (functional(theta + step) - functional(theta - step)) / (2 * h)
        assert float(gradient[k]) == pytest.approx(float(difference), rel=2e-5, abs=1e-4), spec


def test_batching_and_compiling_change_nothing():
    motion, force = loops(LOW_SYMMETRIC, 0.0125, 1.5, [0.0, 0.2, 0.4])
    valve = build(Generalized, LOW_SYMMETRIC)
    np.testing.assert_allclose(jax.jit(lambda m: valve.force(m))(motion), force, rtol=1e-12)
    np.testing.assert_allclose(jax.vmap(valve.force)(motion), force, rtol=1e-12)
