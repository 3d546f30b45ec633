"""The spring in series against an independent solution, at its limits, and in both modes of AD."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sysid.effects.force.fluid_inertia import FluidInertia
from sysid.effects.law.bypass_leakage import BypassLeakage
from sysid.effects.law.seating_leakage import SeatingLeakage
from sysid.effects.motion.series_compliance import SeriesCompliance
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import as_dict, build
from tests.models.rival_examples import example

VALVE = build(Generalized, LOW_SYMMETRIC)
AMPLITUDE, FREQUENCY, CURRENT = 0.0125, 2.5, 0.4
force = eqx.filter_jit(lambda damper, motion: damper.force(motion))


def damper(compliance: float) -> Damper:
    return Damper(VALVE, (SeriesCompliance(compliance),))


def loop(points: int) -> Motion:
    return sine_motion(AMPLITUDE, FREQUENCY, CURRENT, points=points)


def radau(compliance: float, points: int) -> np.ndarray:
    """s Ḟ = v − w with w from F = Φ(w), in W11's own equations; stops at each change of sgn ẍ."""
    p = LOW_SYMMETRIC
    omega = 2.0 * np.pi * FREQUENCY
    v_m = omega * AMPLITUDE

    def rise(a: float, offset: float) -> float:
        return 1 / (1 + np.exp(-a * (CURRENT + offset))) - 1 / (1 + np.exp(-a * offset))

    top = (1 + p["k_2"] * rise(p["a_2"], p["I_0"])) * p["F_0"] * (1 + np.exp(p["a_1"] * v_m))
    steep = 0.5 * p["a_0"] / (1 + p["k_0"] * v_m)
    width = p["k_4"] * v_m * (1 + p["k_3"] * rise(p["a_3"], p["I_1"]))
    k_v = p["k_1c"] * np.exp(-p["a_4"] * v_m)

    def phi(w: float, sign: float) -> float:
        return top * np.tanh(steep * (w + sign * width)) * (1 + k_v * abs(w))

    def velocity_at(carried: float, sign: float) -> float:
        return brentq(lambda w: phi(w, sign) - carried, -9.0, 9.0, xtol=1e-15)

    answer, start = [], 0.0
    half = 0.5 / FREQUENCY
    for k in range(4):
        sign = -1.0 if k % 2 == 0 else 1.0
        at = k * half + np.arange(points // 2) * 2 * half / points
        solved = solve_ivp(
            lambda t, f, s=sign: [(v_m * np.cos(omega * t) - velocity_at(f[0], s)) / compliance],
            (k * half, (k + 1) * half), [start], method="Radau", rtol=1e-5, atol=1e-2,
            t_eval=[*at, (k + 1) * half],
        )  # fmt: skip
        answer.append(solved.y[0, :-1])
        start = float(solved.y[0, -1])
    return np.concatenate(answer[2:])


@pytest.mark.parametrize("compliance", [2.5e-8, 5e-7])
def test_loop_is_that_of_a_stiff_solver(compliance):
    """1/40 to 1/2 MN/m: below 1 % of the largest force, at 72 points and at 360."""
    reference = radau(compliance, 360)
    largest = np.abs(reference).max()
    fine = np.asarray(force(damper(compliance), loop(360)))[0]
    coarse = np.asarray(force(damper(compliance), loop(72)))[0]
    assert np.abs(fine - reference).max() < 0.01 * largest
    assert np.abs(coarse - reference[::5]).max() < 0.01 * largest
    stiff = np.asarray(VALVE.force(loop(360)))[0]
    assert np.std(stiff - reference) > 10 * np.std(fine - reference)


def test_spring_and_valve_carry_the_same_force():
    """v_v = v − s dF/dt to the accuracy of the grid, by harmonics of the result."""
    motion = loop(360)
    effect = SeriesCompliance(3e-7)
    inner = eqx.filter_jit(lambda e, m: e.at_valve(m, VALVE.force))(effect, motion)
    carried = np.asarray(VALVE.force(inner))
    np.testing.assert_allclose(
        np.asarray(motion.displacement - inner.displacement), 3e-7 * carried, atol=1e-9
    )
    rate = np.fft.irfft(np.fft.rfft(carried) * 2j * np.pi * FREQUENCY * np.arange(181), n=360)
    lost = np.asarray(motion.velocity - inner.velocity)
    assert np.sqrt(np.mean((lost - 3e-7 * rate) ** 2)) < 0.05 * np.sqrt(np.mean(lost**2))
    assert np.array_equal(inner.peak_velocity, motion.peak_velocity)
    assert np.array_equal(inner.acceleration_sign, motion.acceleration_sign)


def test_both_modes_of_differentiation_agree_with_differences():
    motion = loop(72)
    weights = jnp.asarray(np.random.default_rng(1).normal(size=72))

    def total(s: jax.Array, f: jax.Array) -> jax.Array:
        valve = eqx.tree_at(lambda v: v.F_0, VALVE, f)
        return jnp.sum(weights * Damper(valve, (SeriesCompliance(s),)).force(motion)[0])

    at = (jnp.asarray(2e-7), jnp.asarray(70.0))
    forward = jax.jit(jax.jacfwd(total, argnums=(0, 1)))(*at)
    backward = jax.jit(jax.grad(total, argnums=(0, 1)))(*at)
    value = jax.jit(total)
    by_s = (value(at[0] + 1e-12, at[1]) - value(at[0] - 1e-12, at[1])) / 2e-12
    by_f = (value(at[0], at[1] + 1e-3) - value(at[0], at[1] - 1e-3)) / 2e-3
    np.testing.assert_allclose(forward, (by_s, by_f), rtol=1e-4)
    np.testing.assert_allclose(backward, forward, rtol=1e-8)


def test_a_mass_behind_the_spring_resonates_as_it_should():
    """With m behind a spring s and a nearly rigid-free valve, F = m a / (1 − s m ω²) on top."""
    soft = eqx.tree_at(lambda v: v.F_0, VALVE, jnp.asarray(1e-9))
    mass, s, f = 3.0, 5e-7, 15.0
    motion = sine_motion(0.0025, f, 0.0, points=360)
    found = force(Damper(soft, (SeriesCompliance(s), FluidInertia(mass))), motion)
    gain = 1.0 / (1.0 - s * mass * (2 * np.pi * f) ** 2)
    expected = gain * mass * np.asarray(motion.acceleration)
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


def test_time_history_settles_on_the_loop():
    """The same sine as a record of three cycles, from rest: the third is the loop."""
    points = 720
    t = np.arange(3 * points) / (points * FREQUENCY)
    omega = 2 * np.pi * FREQUENCY
    x = AMPLITUDE * np.sin(omega * t)
    motion = time_motion(
        t, x, velocity=AMPLITUDE * omega * np.cos(omega * t), acceleration=-(omega**2) * x,
        current=CURRENT,
    )  # fmt: skip
    record = np.asarray(force(damper(1e-7), motion))[2 * points :]
    cycle = np.asarray(force(damper(1e-7), loop(points)))[0]
    keep = np.arange(points) % (points // 2) != 0
    assert np.abs(record - cycle)[keep].max() < 0.02 * np.abs(cycle).max()
    assert np.sqrt(np.mean((record - cycle) ** 2)) < 0.003 * np.abs(cycle).max()


def test_a_leak_behind_the_spring_is_solved_too():
    """Spring and valve carry one force, also while the leak closes."""
    motion, s = loop(360), 5e-8
    behind = Damper(VALVE, (SeatingLeakage(2e-5, 4e-4, 1.0),))
    inner = eqx.filter_jit(lambda e, m: e.at_valve(m, behind.force))(SeriesCompliance(s), motion)
    carried = np.asarray(behind.force(inner))
    back = np.asarray(motion.displacement - inner.displacement) / s
    assert np.std(back - carried) < 0.1 * np.std(carried)
    from_velocity = np.cumsum(np.asarray(motion.velocity - inner.velocity)) / (360 * FREQUENCY * s)
    off = from_velocity - carried[0]
    assert np.std(off) < 0.05 * np.std(carried)


def test_leaks_behind_the_spring_are_solved_with_it():
    """One equation in the speed at the valve gives what a root inside a root gives."""
    spring = SeriesCompliance(1e-7)
    behind = Damper(
        VALVE, (SeatingLeakage(2e-5, 4e-4, 2.0), BypassLeakage(1e-6), FluidInertia(8.0))
    )
    motion = loop(72)
    inner = eqx.filter_jit(lambda e, m: e.at_valve(m, behind.force))(spring, motion)
    nested = np.asarray(force(behind, inner))
    together = np.asarray(force(Damper(VALVE, (spring, *behind.effects)), motion))
    assert np.abs(together - nested).max() < 1e-8 * np.abs(nested).max()


def bouc_wen_chain(model: str, s: float, leakage: float, points: int) -> np.ndarray:
    """Element, dashpot, leak and spring as a differential equation in u, w and the valve's force.

    s dF/dt = v − v_v with F = F' + k_1 x_v + f_0, F' = α w + c_0 u' + k_0 u, v_v = u' + F' μ.
    """
    p = as_dict(example(model))
    amplitude, omega, current = 0.0025, 20.0 * np.pi, 0.4
    field = (1.0 - np.exp(-p["q"] * current)) / p["q"]
    alpha = p["alpha_a"] + p["alpha_b"] * field
    two = model == "modified_bouc_wen"
    inner = (p["c_0a"] + p["c_0b"] * field) if two else (p["c_a"] + p["c_b"] * field)
    k_0, beside = (p["k_0"], p["k_1"]) if two else (0.0, p["k_0"])
    mu = leakage + (1.0 / (p["c_1a"] + p["c_1b"] * field) if two else 0.0)

    def rate_of_state(rate: float, w: float) -> float:
        if model == "dahl":
            return p["rho"] * (rate - abs(rate) * w)
        sigma = p["sigma"]
        return p["rho"] * (rate - sigma * abs(rate) * abs(w) * w - (1.0 - sigma) * rate * w * w)

    def slope(t: float, state: np.ndarray) -> list[float]:
        u, w, carried = state
        rate = (carried - alpha * w - k_0 * u) / inner
        valve = rate + mu * carried
        rises = (amplitude * omega * np.cos(omega * t) - valve * (1.0 + s * beside)) / s
        return [rate, rate_of_state(rate, w), rises]

    at = (3.0 + np.arange(points) / points) * 2.0 * np.pi / omega
    solved = solve_ivp(
        slope, (0.0, at[-1]), [0.0, 0.0, 0.0], method="Radau", rtol=1e-6, atol=[1e-10, 1e-7, 1e-4],
        t_eval=at, max_step=5e-4,
    )  # fmt: skip
    whole = solved.y[2] + beside * amplitude * np.sin(omega * at) + p["f_0"]
    return whole / (1.0 + beside * s)


@pytest.mark.parametrize("model", ["dahl", "bouc_wen", "modified_bouc_wen"])
@pytest.mark.parametrize(("s", "leakage"), [(5e-7, 0.0), (5e-8, 2e-5)])
def test_valves_with_hysteresis_take_spring_and_leak_into_their_state(model, s, leakage):
    """2 to 20 MN/m before valves that bend by a third of it: 0.2 % of the largest force."""
    reference = bouc_wen_chain(model, s, leakage, 360)
    effects = (SeriesCompliance(s), BypassLeakage(leakage))
    largest = np.abs(reference).max()
    for points in (72, 360):
        motion = sine_motion(0.0025, 10.0, 0.4, points=points)
        found = np.asarray(force(Damper(example(model), effects), motion))[0]
        assert np.abs(found - reference[:: 360 // points]).max() < 0.002 * largest
    stiff = np.asarray(example(model).force(motion))[0]
    assert np.std(stiff - reference) > 0.02 * largest


@pytest.mark.parametrize("model", ["dahl", "bouc_wen", "modified_bouc_wen"])
def test_derivatives_of_a_valve_with_hysteresis_behind_a_spring_meet_differences(model):
    motion = sine_motion(np.array([0.0025, 0.01]), np.array([10.0, 1.0]), 0.4, points=72)
    weights = jnp.asarray(np.random.default_rng(2).normal(size=(2, 72)))

    def total(z: jax.Array) -> jax.Array:
        valve = eqx.tree_at(lambda v: v.rho, example(model), 1500.0 * z[2])
        around = (SeriesCompliance(2e-7 * z[0]), BypassLeakage(1e-5 * z[1]))
        return jnp.sum(weights * Damper(valve, around).force(motion))

    value, at, step = jax.jit(total), jnp.ones(3), 1e-5
    expected = [(value(at + step * e) - value(at - step * e)) / (2 * step) for e in jnp.eye(3)]
    found = jax.jit(jax.grad(total))(at)
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-5 * np.abs(expected).max())
    np.testing.assert_allclose(jax.jit(jax.jacfwd(total))(at), found, rtol=1e-8)
