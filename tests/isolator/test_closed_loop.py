"""The closed loop against SciPy, energy, and limits that are known in closed form."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.signal import StateSpace, lsim

from sysid.isolator.base_motion import BaseMotion, butterworth_motion
from sysid.isolator.closed_loop import Clock, performance, sampled, trace
from sysid.isolator.controllers.passive import Passive
from sysid.isolator.controllers.proportional import proportional
from sysid.isolator.damper_step import NoDamper
from sysid.isolator.fractional_power import fractional_power
from sysid.isolator.frequency_dependent import frequency_dependent
from sysid.isolator.lumped_step import Broken, LumpedStep, lumped_step
from sysid.isolator.plant import MASS, mass_isolator
from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.time_motion import time_motion

STIFFNESS = MASS * (10.0 * np.pi) ** 2
run = jax.jit(trace, static_argnums=4)


def first(base, clock):
    return jax.tree.map(lambda z: z[0], sampled(base, clock))


def spline_of(base):
    grid = base.interval * np.arange(base.displacement.shape[1])
    return CubicSpline(grid, base.displacement[0], bc_type=((1, 0.0), (2, 0.0)))


def by_scipy(base, temperature, samples):
    """P control with D = 2 kN·s/m, sampled at 1 kHz, from the paper's equations."""
    spline, speed = spline_of(base), spline_of(base).derivative()
    places = np.arange(6) / 5
    post, yielding = (
        np.array([
            TABLE_1[f"{law}[{i:g} A].intercept"] + TABLE_1[f"{law}[{i:g} A].slope"] * temperature
            for i in places
        ])
        for law in ("C_post", "F_y")
    )  # fmt: skip
    k = 1e3 * (1500 + 150 * temperature)

    def rates(t, z, command):
        x, v, u, w, i = z
        c, f = np.interp(i, places, post), np.interp(i, places, yielding)
        chi = c * w + np.clip((1e5 - c) * w, -f, f)
        return [
            v, (STIFFNESS * (spline(t) - x) + k * u) / MASS, speed(t) - v - w,
            (k * u - chi) / 2.0, (command - i) / 0.003,
        ]  # fmt: skip

    state, rows = np.zeros(5), []
    for n in range(samples):
        t = 1e-3 * n
        rows.append(state)
        rate, force = speed(t) - state[1], k * state[2]
        on = state[1] * -rate >= 0.0
        command = 0.0012 * (-2000.0 * state[1] - 0.6 * force) * np.sign(rate) if on else 0.0
        state = solve_ivp(
            rates, (t, t + 1e-3), state, "Radau", rtol=1e-7, atol=1e-10,
            args=(min(max(command, 0.0), 1.0),),
        ).y[:, -1]  # fmt: skip
    rows = np.array(rows)
    return k * rows[:, 2], rows


def test_a_controlled_run_is_that_of_scipy_and_converges_with_second_order(valve, number):
    base = butterworth_motion([5], duration=0.05, level=8e-3)
    force, states = by_scipy(base, 15.0, 50)
    assert states[:, 4].max() > 0.05  # the controller acts
    errors = []
    for steps in (4, 16):
        clock = Clock(1e-3, steps)
        found = run(
            mass_isolator(), lumped_step(valve, number(15)), proportional(number(2000)),
            first(base, clock), clock,
        )  # fmt: skip
        errors.append(np.abs(np.asarray(found.force) - force).max() / np.abs(force).max())
    assert errors[0] < 1e-2
    assert errors[1] < errors[0] / 8.0
    np.testing.assert_allclose(found.current, states[:, 4], rtol=0, atol=1e-3 * states[:, 4].max())


def test_energy_balances(valve, number):
    """Work of the base = heat + what is stored in mass, springs and fluid."""
    clock = Clock(1e-4, 2)
    base = butterworth_motion([1], duration=0.4)
    damper, one = lumped_step(valve, number(40)), first(base, clock)
    found = run(mass_isolator(), damper, Passive(number(0.3)), one, clock)
    v = found.state[1]
    compression, force = np.asarray(found.working_space), np.asarray(found.force)
    into = (STIFFNESS * compression + force) * np.asarray(one.at.velocity)
    heat = np.asarray(damper.dissipating(found.damper, found.current))
    stored = 0.5 * MASS * v**2 + 0.5 * STIFFNESS * compression**2
    stored += 0.5 * damper.stiffness * found.damper.u**2 + 0.5 * damper.mass * found.damper.w**2
    assert heat.min() >= 0.0
    work, lost = np.trapezoid(into, dx=1e-4), np.trapezoid(heat, dx=1e-4)
    assert lost > 0.5 * work > 0.0
    assert float(stored[-1]) + lost == pytest.approx(work, rel=2e-3)


def linear_damper(viscosity, number):
    """No yield force, and a spring too stiff to be felt."""
    flat = Broken(number(viscosity), number(0), (), ())
    none = Broken(number(1e-6), number(0), (), ())
    return LumpedStep(number(0.003), number(1e-3), number(1e5), number(1e9), flat, none, (0.0, 1.0))


def test_without_yield_it_is_the_linear_isolator(number):
    base, clock = butterworth_motion([5], duration=1.0), Clock(1e-3, 8)
    found = run(
        mass_isolator(),
        linear_damper(1300.0, number),
        Passive(number(0)),
        first(base, clock),
        clock,
    )
    time = np.linspace(0.0, 1.0, 20001)
    spline = spline_of(base)
    c, k = 1300.0 / MASS, STIFFNESS / MASS
    system = StateSpace([[0, 1], [-k, -c]], [[0, 0], [k, c]], [[1, 0]], [[0, 0]])
    inputs = np.column_stack([spline(time), spline(time, 1)])
    exact = lsim(system, inputs, time)[1][:-1:20]
    assert np.abs(np.asarray(found.state[0]) - exact).max() < 2e-4 * np.abs(exact).max()


def sine(frequency, seconds):
    t = 1e-3 * np.arange(round(1e3 * seconds) + 1)
    return BaseMotion(1e-3, 1e-3 * (1.0 - np.cos(2 * np.pi * frequency * t))[None], "sine")


@pytest.mark.parametrize("damping", [500.0, 3000.0])
def test_the_ideal_skyhook_transmits_as_in_closed_form(damping, number):
    """|X_m/X_b| = k_s / |k_s − M ω² + i D ω|, once started up."""
    frequency, clock = 7.0, Clock(1e-3, 8)
    found = run(
        mass_isolator(skyhook=damping), NoDamper(number(1)), Passive(number(0)),
        first(sine(frequency, 4.0), clock), clock,
    )  # fmt: skip
    last = np.asarray(found.state[0])[-1000:]
    omega = 2 * np.pi * frequency
    exact = STIFFNESS / abs(STIFFNESS - MASS * omega**2 + 1j * damping * omega)
    assert np.ptp(last) / 2e-3 == pytest.approx(exact, rel=2e-3)


def test_behind_a_heavy_mass_the_damper_is_the_model(valve, number):
    """The piston then moves as the base does, and the force is that of `Lumped`, solved exactly."""
    base, clock = butterworth_motion([2], duration=0.5), Clock(1e-3, 16)
    found = run(
        mass_isolator(1e9, 1.0), lumped_step(valve, number(55)), Passive(number(0.5)),
        first(base, clock), clock,
    )  # fmt: skip
    x, v = (z[0] for z in base.at(1e-3 * np.arange(500)))
    current = 0.5 * (1.0 - np.exp(-np.arange(500) / 3.0))
    at_once = Lumped(**{**vars(valve), "tau": jnp.asarray(1e-9)})
    motion = time_motion(1e-3 * np.arange(500), x, velocity=v, current=current, temperature=55.0)
    exact = np.asarray(simulate(at_once, motion))
    np.testing.assert_allclose(found.current, current, atol=1e-12)
    error = np.asarray(found.force)[50:] - exact[50:]
    assert np.sqrt(np.mean(error**2)) < 2e-3 * np.abs(exact).max()


def test_rms_values_are_those_of_the_trace(valve, number):
    base, clock = butterworth_motion([4], duration=0.1), Clock(1e-3, 2)
    parts = (mass_isolator(), lumped_step(valve, number(30)), proportional(number(3000)))
    seen = run(*parts, first(base, clock), clock)
    judged = performance(*parts, first(base, clock), clock, fastest=0.1)
    assert judged.acceleration == pytest.approx(float(np.sqrt(np.mean(seen.acceleration**2))))
    assert judged.working_space == pytest.approx(float(np.sqrt(np.mean(seen.working_space**2))))
    assert judged.piston_speed == pytest.approx(float(np.abs(seen.piston_velocity).max()))
    assert judged.beyond == pytest.approx(float(np.mean(np.abs(seen.piston_velocity) > 0.1)))


def test_a_run_that_ran_away_was_beyond_what_was_tested(number):
    base, clock = BaseMotion(1e-3, np.zeros((1, 101)), "still"), Clock(1e-3, 2)
    lost = jax.tree.map(lambda z: z.at[50:].set(jnp.nan), first(base, clock))
    parts = (mass_isolator(), NoDamper(number(1)), Passive(number(0)))
    assert performance(*parts, lost, clock, fastest=0.1).beyond == pytest.approx(0.5, abs=0.02)


def test_a_force_that_grows_with_frequency(number):
    """On a steady sine the linear damper's force is |H| times as large, 1 + ε a decade up."""
    for frequency in (1.0, 10.0):
        expected = 1.0 + 0.2 * np.log10(frequency)
        assert fractional_power(0.2).factor(frequency) == pytest.approx(expected, rel=0.02)
    clock, damper = Clock(1e-3, 4), linear_damper(1000.0, number)
    forces = [
        np.ptp(np.asarray(run(
            mass_isolator(1e9, 1.0), one, Passive(number(0)), first(sine(10.0, 1.0), clock), clock
        ).force)[-200:])
        for one in (damper, frequency_dependent(damper, 0.2))
    ]  # fmt: skip
    assert forces[1] / forces[0] == pytest.approx(fractional_power(0.2).factor(10.0), rel=5e-3)
