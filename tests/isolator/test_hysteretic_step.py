"""Models with a state in the loop: against SciPy and `simulate`, at rest, energy, when stiff."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from sysid.effects.bristle import bent
from sysid.effects.force.gas_spring import GasSpring
from sysid.effects.force.presliding_friction import PreslidingFriction
from sysid.isolator.base_motion import BaseMotion, butterworth_motion
from sysid.isolator.closed_loop import Clock, Trace, sampled, trace
from sysid.isolator.controllers.gain_schedule import GainSchedule
from sysid.isolator.controllers.passive import Passive
from sysid.isolator.families import family
from sysid.isolator.frequency_dependent import frequency_dependent
from sysid.isolator.from_card import HYSTERETIC, damper_of_card
from sysid.isolator.memory import instant
from sysid.isolator.plant import MASS, mass_isolator
from sysid.isolator.pointwise_step import PointwiseStep
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.time_motion import time_motion
from tests.cards.export.dampers import RIVAL, effect
from tests.isolator.conftest import card_of

STIFFNESS = MASS * (10.0 * np.pi) ** 2
CURRENT, LAG = 0.3, 0.003
BESIDE = (
    effect("current_saturation"), effect("eddy_loss"), effect("viscosity_temperature"),
    effect("stiffness_temperature"), effect("seal_friction"), effect("presliding_friction"),
    effect("stribeck_friction"),
)  # fmt: skip
COOL = 25.0
"""°C, where the laws of temperature change the valve."""
FINE = Clock(1.25e-4, 1)
"""Every step is seen."""
run = jax.jit(trace, static_argnums=4)


def step_of(model: str, *effects, **changed: float) -> PointwiseStep:
    step = damper_of_card(card_of(model, *effects)).step(COOL)
    assert isinstance(step, PointwiseStep)
    for name, value in changed.items():
        step = eqx.tree_at(
            lambda s, n=name: (getattr(s.damper.valve, n), getattr(s.memories[0].valve, n)),
            step, (jnp.asarray(value), jnp.asarray(value)),
        )  # fmt: skip
    return step


def one(base: BaseMotion, clock: Clock):
    return jax.tree.map(lambda z: z[0], sampled(base, clock))


def burst() -> BaseMotion:
    """A sine of 5 mm and 8 Hz that swells up and dies away, and then the base stands still."""
    t = 1e-3 * np.arange(2001)
    share = np.clip(np.minimum(t, 1.25 - t) / 0.25, 0.0, 1.0)
    swell = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    return BaseMotion(1e-3, (5e-3 * swell * np.sin(16.0 * np.pi * t))[None], "burst")


@pytest.fixture(scope="module", params=HYSTERETIC)
def burst_run(request) -> tuple[str, Trace]:
    step = step_of(request.param, *BESIDE)
    return request.param, run(
        mass_isolator(), step, Passive(jnp.asarray(CURRENT)), one(burst(), FINE), FINE
    )


def test_the_force_is_that_of_simulate_on_the_same_motion(burst_run):
    """Flows are exact in both: on the travel that the loop integrated nothing is left."""
    model, found = burst_run
    valve = step_of(model).damper.valve
    motion = time_motion(
        FINE.period * np.arange(found.force.size), np.asarray(found.working_space),
        velocity=np.asarray(found.piston_velocity), current=np.asarray(found.current),
        temperature=COOL,
    )  # fmt: skip
    strides = jnp.diff(found.damper.travelled, append=0.0)
    integrated = eqx.tree_at(lambda m: m.travel, motion, strides, is_leaf=lambda z: z is None)
    errors = []
    for one_motion in (motion, integrated):
        expected = np.asarray(simulate(Damper(valve, BESIDE), one_motion))
        errors.append(np.abs(np.asarray(found.force) - expected).max() / np.abs(expected).max())
    assert np.abs(np.asarray(found.working_space)).max() > 1e-3
    assert errors[0] < 1e-5
    assert errors[1] < (1e-5 if model == "modified_bouc_wen" else 1e-6)


def test_it_comes_to_rest_in_balance(burst_run):
    _, found = burst_run
    end = -400
    speed = np.abs(np.asarray(found.piston_velocity))
    assert speed[end:].max() < 1e-3 * speed.max()
    balance = STIFFNESS * np.asarray(found.working_space)[end:] + np.asarray(found.force)[end:]
    assert np.abs(balance).max() < 1e-3 * np.abs(found.force).max()


def test_closed_cycles_cost_energy_and_it_balances(burst_run):
    """Work of the base = work on the damper + what mass and spring hold."""
    _, found = burst_run
    force, x, v = (np.asarray(z) for z in (found.force, found.working_space, found.piston_velocity))
    for begin in (0.25, 0.5, 0.75):
        cycle = slice(round(begin / FINE.period), round((begin + 0.25) / FINE.period) + 1)
        assert np.trapezoid(force[cycle], x[cycle]) > 0.05 * np.ptp(force) * np.ptp(x)
    rate = np.asarray(one(burst(), FINE).at.velocity)
    into = np.trapezoid((STIFFNESS * x + force) * rate, dx=FINE.period)
    lost = np.trapezoid(force * v, dx=FINE.period)
    held = 0.5 * MASS * float(found.state[1][-1]) ** 2 + 0.5 * STIFFNESS * x[-1] ** 2
    assert lost > 0.0
    assert lost + held == pytest.approx(into, rel=2e-4)


def test_nothing_moves_where_the_base_stands_still(burst_run):
    still = jax.tree.map(jnp.zeros_like, one(burst(), FINE))
    step = step_of(burst_run[0], *BESIDE)
    found = run(mass_isolator(), step, Passive(jnp.asarray(CURRENT)), still, FINE)
    assert float(jnp.abs(found.force).max()) == 0.0
    assert float(jnp.abs(found.state[0]).max()) == 0.0


def by_scipy(model: str, base: BaseMotion, samples: int) -> np.ndarray:
    """Force at every millisecond, from the models' printed equations."""
    grid = base.interval * np.arange(base.displacement.shape[1])
    spline = CubicSpline(grid, base.displacement[0], bc_type=((1, 0.0), (2, 0.0)))  # pyright: ignore[reportArgumentType]
    speed, p = spline.derivative(), RIVAL

    def parts(t, z):
        x, v, w, u = z
        s = -np.expm1(-p["q"] * CURRENT * -np.expm1(-t / LAG)) / p["q"]
        d, rate, alpha = spline(t) - x, speed(t) - v, p["alpha_a"] + p["alpha_b"] * s
        if model == "modified_bouc_wen":
            inner, outer = (p[f"c_{n}a"] + p[f"c_{n}b"] * s for n in (0, 1))
            y_rate = (alpha * w + inner * rate + p["k_0"] * u) / (inner + outer)
            return outer * y_rate + p["k_1"] * d, d, rate - y_rate
        return (p["c_a"] + p["c_b"] * s) * rate + p["k_0"] * d + alpha * w, d, rate

    def rates(t, z):
        force, d, along = parts(t, z)
        _, v, w, _ = z
        kept = w if model == "dahl" else w * (p["sigma"] * abs(w))
        w_rate = p["rho"] * (along - abs(along) * kept)
        if model != "dahl":
            w_rate -= p["rho"] * (1.0 - p["sigma"]) * along * w * w
        return [v, (STIFFNESS * d + force) / MASS, w_rate, along]

    at = 1e-3 * np.arange(samples)
    states = solve_ivp(
        rates, (0.0, at[-1]), np.zeros(4), "LSODA", at, rtol=1e-9, atol=1e-12, max_step=5e-4
    ).y  # fmt: skip
    return np.array([parts(t, z)[0] for t, z in zip(at, states.T, strict=True)])


@pytest.mark.parametrize("model", ["bouc_wen", "modified_bouc_wen"])
def test_the_loop_is_that_of_scipy_and_converges_with_second_order(model):
    base = butterworth_motion([5], duration=0.2, level=4e-3)
    force = by_scipy(model, base, 200)
    step, errors = step_of(model), []
    for steps in (2, 8):
        clock = Clock(1e-3, steps)
        found = run(mass_isolator(), step, Passive(jnp.asarray(CURRENT)), one(base, clock), clock)
        errors.append(np.abs(np.asarray(found.force) - force).max() / np.abs(force).max())
    assert errors[0] < 1e-2
    assert errors[1] < errors[0] / 7.0


def test_a_valve_that_yields_within_a_nanometre_holds_the_mass_without_ringing():
    """Far below its yield force it is a rigid link: the mass does what the base does."""
    t = 1e-3 * np.arange(201)
    base = BaseMotion(1e-3, (1e-3 * (1.0 - np.cos(10.0 * np.pi * t)) ** 2)[None], "sine")
    step, clock = step_of("bouc_wen", rho=1e9, alpha_b=2e4), Clock(1e-3, 2)
    found = run(mass_isolator(), step, Passive(jnp.asarray(CURRENT)), one(base, clock), clock)
    state = np.asarray(found.damper.remembered[0][0])
    assert np.abs(state).max() <= 1.0
    seen = one(base, clock).at
    needed = MASS * np.gradient(np.asarray(seen.velocity), 1e-3)
    late = slice(20, 180)
    force = np.asarray(found.force)[late]
    assert np.abs(force - needed[late]).max() < 0.05 * np.abs(needed).max()
    assert np.abs(np.diff(force)).sum() < 1.1 * np.abs(np.diff(needed[late])).sum()
    assert np.abs(np.asarray(found.working_space)).max() < 1e-6


def test_its_static_force_is_carried_by_the_spring_and_read_by_the_sensor():
    damper = damper_of_card(card_of("dahl", GasSpring(k_g=jnp.asarray(1500.0))))
    assert damper.gas.preload == RIVAL["f_0"]
    assert damper.gas.stiffness == 1500.0
    step = damper.step(COOL)
    assert isinstance(step, PointwiseStep)
    still = jnp.zeros(())
    at = instant(still, still, still, still, still, jnp.asarray(40.0))
    assert float(step.force(at, step.start().remembered)) == 0.0


@pytest.mark.parametrize("model", HYSTERETIC)
def test_the_table_of_gain_scheduling_is_past_yielding(model):
    step = step_of(model, effect("presliding_friction"))
    schedule = family("GS", step).controllers
    assert isinstance(schedule, GainSchedule)
    forces = np.asarray(schedule.forces)[0]
    assert np.all(np.diff(forces) > 0.0)
    speed, p = 0.1, RIVAL
    friction = PreslidingFriction.facts.nominal["F_ps"]
    found = float(step.at_speed(speed, jnp.zeros(1))[0]) - friction
    if model == "modified_bouc_wen":
        share = p["c_1a"] / (p["c_0a"] + p["c_1a"])
        assert found == pytest.approx(share * (p["alpha_a"] + p["c_0a"] * speed))
    else:
        assert found == pytest.approx(p["alpha_a"] + p["c_a"] * speed)


def test_behind_a_filter_of_frequency_the_state_still_counts_from_the_step():
    """ε = 0 is no filter: the wrapped damper must do the same."""
    step, clock = step_of("bouc_wen"), Clock(1e-3, 2)
    base = one(butterworth_motion([5], duration=0.2, level=4e-3), clock)
    alone, wrapped = (
        np.asarray(run(mass_isolator(), z, Passive(jnp.asarray(CURRENT)), base, clock).force)
        for z in (step, frequency_dependent(step, 0.0))
    )
    np.testing.assert_allclose(wrapped, alone, rtol=0, atol=1e-7 * np.abs(alone).max())


def test_beside_a_model_without_memory_the_bristle_is_bent_as_the_effect_has_it():
    friction = PreslidingFriction(F_ps=jnp.asarray(40.0), sigma_0=jnp.asarray(3e5))
    step = damper_of_card(card_of("tanh", friction)).step(40.0)
    base = one(butterworth_motion([5], duration=0.2, level=2e-3), FINE)
    found = run(mass_isolator(), step, Passive(jnp.asarray(CURRENT)), base, FINE)
    motion = time_motion(
        FINE.period * np.arange(found.force.size), np.asarray(found.working_space),
        velocity=np.asarray(found.piston_velocity), current=CURRENT,
    )  # fmt: skip
    expected = np.asarray(bent(motion, friction.F_ps / friction.sigma_0))
    assert expected.min() < -0.9 < 0.9 < expected.max()
    np.testing.assert_allclose(found.damper.remembered[0][0], expected, rtol=0, atol=1e-3)


def test_runs_side_by_side_are_those_of_single_ones():
    """Mapped searches go on until the last has settled, which must not move the others."""
    step, clock = step_of("bouc_wen"), Clock(1e-3, 2)
    bases = butterworth_motion([5, 6, 7], duration=0.2, level=4e-3)
    controller = Passive(jnp.asarray(CURRENT))
    together = jax.jit(jax.vmap(lambda z: trace(mass_isolator(), step, controller, z, clock).force))
    alone = np.asarray(run(mass_isolator(), step, controller, one(bases, clock), clock).force)
    found = np.asarray(together(sampled(bases, clock)))
    np.testing.assert_allclose(found[0], alone, rtol=0, atol=1e-7 * np.abs(alone).max())
    assert np.abs(found[1] - alone).max() > 0.1 * np.abs(alone).max()
