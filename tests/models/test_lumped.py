"""The lumped model: Table 1, limits, steady cycles, derivatives, parts."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sysid.effects.base import Parts
from sysid.effects.force.linear_viscosity import LinearViscosity
from sysid.effects.law.bypass_leakage import BypassLeakage
from sysid.effects.law.frequency_law import FrequencyLaw
from sysid.effects.law.stiffness_temperature import StiffnessTemperature
from sysid.effects.law.viscosity_temperature import ViscosityTemperature
from sysid.effects.law.yield_temperature import YieldTemperature
from sysid.effects.motion.series_compliance import SeriesCompliance
from sysid.models.biviscous_step import BRANCHES
from sysid.models.damper import Damper
from sysid.models.lumped import CURRENTS, TABLE_1, Lumped, element_force
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build, specs, values

POINTS = 72
AMPLITUDE, FREQUENCY, CURRENT, TEMPERATURE = np.array(
    [(a, f, i, t) for a, f in ((0.010, 8.0), (0.005, 4.0)) for i in CURRENTS for t in (15.0, 75.0)]
).T
"""The paper's loops, [24]."""
LOOPS = sine_motion(AMPLITUDE, FREQUENCY, CURRENT, TEMPERATURE, points=POINTS)
FINE = sine_motion(AMPLITUDE, FREQUENCY, CURRENT, TEMPERATURE, points=720)
VALVE = build(Lumped, TABLE_1)


def lumped(**changes: float) -> Lumped:
    return build(Lumped, TABLE_1 | changes)


def tabled(law: str, intercept: float, slope: float | None = None) -> dict[str, float]:
    """The same line at every current of the table."""
    level = {f"{law}[{i:g} A].intercept": intercept for i in CURRENTS}
    return level | ({} if slope is None else {f"{law}[{i:g} A].slope": slope for i in CURRENTS})


def at(current: float, temperature: float | None) -> dict[str, float]:
    element = VALVE.element(sine_motion(0.01, 8.0, current, temperature))
    return {name: float(np.ravel(z)[0]) for name, z in element._asdict().items() if z is not None}


def change(name: str, current: float, cold: float, hot: float) -> float:
    return 100.0 * (at(current, hot)[name] / at(current, cold)[name] - 1.0)


@pytest.mark.parametrize(
    ("current", "temperature", "post", "yielding"),
    [
        (0.0, 15.0, 1298.3, 43.85),
        (0.2, 15.0, 1158.95, 323.05),
        (0.4, 45.0, 1086.05, 681.85),
        (0.6, 45.0, 1222.7, 1021.85),
        (0.8, 75.0, 1065.75, 1086.5),
        (1.0, 75.0, 1116.75, 1185.5),
    ],
)
def test_the_table_is_met_at_its_currents(current, temperature, post, yielding):
    found = at(current, temperature)
    assert found["post"] == pytest.approx(post, rel=1e-12)
    assert found["yielding"] == pytest.approx(yielding, rel=1e-12)
    assert found["stiffness"] == pytest.approx(1e3 * (1500 + 150 * temperature), rel=1e-12)
    assert (found["pre"], found["mass"]) == (1.0e5, 2.0)


def test_changes_with_temperature_are_those_of_figure_5():
    assert change("post", 0.8, 15.0, 75.0) == pytest.approx(-33.4, abs=0.05)
    assert change("yielding", 0.8, 15.0, 75.0) == pytest.approx(-22.5, abs=0.05)
    assert change("stiffness", 1.0, 15.0, 75.0) == pytest.approx(240.0, abs=0.5)
    assert change("stiffness", 1.0, 11.0, 75.0) == pytest.approx(305.0, abs=0.5)
    assert change("yielding", 0.0, 15.0, 75.0) > 0.0


def test_laws_are_straight_between_currents_and_turn_only_where_the_table_does():
    current = np.linspace(0.0, 2.0, 201)
    for temperature in (15.0, 75.0):
        element = VALVE.element(sine_motion(0.01, 8.0, current, temperature, points=8))
        post, yielding = np.asarray(element.post)[:, 0], np.asarray(element.yielding)[:, 0]
        assert (np.diff(post[:21]) < 0.0).all()
        assert (np.diff(post[20:]) > 0.0).all()
        assert (np.diff(yielding) > 0.0).all()
        bends = np.flatnonzero(np.abs(np.diff(yielding, 2)) > 1e-9 * yielding.max())
        np.testing.assert_array_equal(bends + 1, [20, 40, 60, 80])
    assert at(-0.5, 45.0) == at(0.5, 45.0)
    assert at(0.5, None) == at(0.5, 40.0)


def test_lines_carried_too_far_still_give_an_element():
    for temperature in (-60.0, 500.0):
        found = at(0.6, temperature)
        assert 0.0 < found["post"] < found["pre"]
        assert found["yielding"] > 0.0
        assert found["stiffness"] > 0.0


def test_every_loop_dissipates_and_is_symmetric():
    force = np.asarray(simulate(VALVE, LOOPS))
    assert ((force * np.asarray(LOOPS.velocity)).mean(axis=1) > 0.0).all()
    half = np.roll(force, POINTS // 2, axis=1)
    np.testing.assert_allclose(half, -force, atol=1e-9 * np.abs(force).max())


def test_without_spring_and_mass_it_is_the_bi_viscous_law():
    force = np.asarray(
        simulate(lumped(**{"k.intercept": 1e15, "k.slope": 0.0, "m_l": 1e-6}), LOOPS)
    )
    element = VALVE.element(LOOPS)
    v = np.asarray(LOOPS.velocity)
    post, pre, limit = (np.asarray(z) for z in (element.post, element.pre, element.yield_velocity))
    chi = np.where(
        np.abs(v) <= limit, pre * v, post * v + np.sign(v) * np.asarray(element.yielding)
    )
    np.testing.assert_allclose(force, chi, atol=1e-6 * np.abs(chi).max())


def linear_force(viscosity: np.ndarray, points: int = POINTS) -> np.ndarray:
    """A dashpot and a mass behind a spring, by their impedance."""
    s = 2j * np.pi * FREQUENCY
    k = 1e3 * (1500 + 150 * TEMPERATURE)
    behind = 2.0 * s + viscosity
    impedance = k * behind / (behind * s + k)
    turn = np.exp(2j * np.pi * np.arange(points) / points)
    return np.real((impedance * AMPLITUDE * 2 * np.pi * FREQUENCY)[:, None] * turn)


def test_without_yield_it_is_linear_up_to_the_error_of_a_cubic():
    """Twice the points, an eighth of the error or less."""
    valve = lumped(**tabled("F_y", 0.0, 0.0))
    viscosity = np.asarray(VALVE.element(LOOPS).post)[:, 0]
    errors = []
    for points in (POINTS, 2 * POINTS):
        expected = linear_force(viscosity, points)
        motion = sine_motion(AMPLITUDE, FREQUENCY, CURRENT, TEMPERATURE, points=points)
        found = np.asarray(simulate(valve, motion))
        errors.append(np.abs(found - expected).max() / np.abs(expected).max())
    assert errors[0] < 3e-5
    assert errors[1] < errors[0] / 8


def test_before_yield_it_is_linear_and_the_steady_cycle_is_found_at_once():
    """The slowest decay is k/C_pre = 37 1/s: nothing is forgotten within a cycle of 8 Hz."""
    strong = tabled("F_y", 1e6)
    expected = linear_force(np.full(FREQUENCY.size, 1.0e5))
    found = np.asarray(simulate(lumped(**strong), LOOPS))
    np.testing.assert_allclose(found, expected, atol=1e-5 * np.abs(expected).max())


def sine_in_time(amplitude: float, frequency: float, current: float, cycles: int) -> Motion:
    time = np.arange(cycles * POINTS) / (POINTS * frequency)
    omega = 2 * np.pi * frequency
    x = amplitude * np.sin(omega * time)
    v = amplitude * omega * np.cos(omega * time)
    return time_motion(
        time, x, velocity=v, acceleration=-(omega**2) * x, current=current, temperature=30.0
    )


@pytest.mark.parametrize(
    ("amplitude", "frequency", "current"),
    [(0.010, 8.0, 0.4), (0.0003, 50.0, 1.0), (0.00018, 20.0, 0.4)],
)
def test_steady_loops_are_where_a_long_motion_from_rest_ends(amplitude, frequency, current):
    """Fully yielding, hardly forgetting, and just yielding."""
    loop = sine_motion(amplitude, frequency, current, 30.0, points=POINTS)
    steady = np.asarray(simulate(VALVE, loop))[0]
    ran = np.asarray(simulate(VALVE, sine_in_time(amplitude, frequency, current, 60)))
    np.testing.assert_allclose(ran[-POINTS:], steady, atol=1e-8 * np.abs(steady).max())


@pytest.mark.parametrize("viscosity", [3.0, 100.0])
def test_no_switch_is_missed_within_long_steps(viscosity):
    """An element that rings on and dips below v_y for parts of a step, at 72 points and at 720."""
    flat = tabled("C_post", viscosity, 0.0)
    coarse, fine = (np.asarray(simulate(lumped(**flat), m)) for m in (LOOPS, FINE))
    largest = np.abs(fine).max()
    half = np.roll(coarse, POINTS // 2, axis=1)
    np.testing.assert_allclose(half, -coarse, atol=1e-8 * largest)
    np.testing.assert_allclose(coarse, fine[:, ::10], atol=1e-3 * largest)


def test_batches_and_single_tests_agree():
    whole = np.asarray(simulate(VALVE, LOOPS))
    one = sine_motion(AMPLITUDE[7], FREQUENCY[7], CURRENT[7], TEMPERATURE[7], points=POINTS)
    np.testing.assert_allclose(simulate(VALVE, one)[0], whole[7], atol=1e-9 * np.abs(whole).max())


@jax.jit
def force_of(parameters: jax.Array) -> jax.Array:
    return build(VALVE, parameters).force(LOOPS)


def test_many_valves_at_once_are_as_each_alone():
    """As a fit starts: with vmap every branch of a condition runs for every valve."""
    here = values(VALVE)
    many = np.asarray(jax.jit(jax.vmap(force_of))(jnp.stack([here, 0.8 * here])))
    np.testing.assert_allclose(many[0], force_of(here), atol=1e-9 * np.abs(many).max())
    np.testing.assert_allclose(many[1], force_of(0.8 * here), atol=1e-9 * np.abs(many).max())


@pytest.fixture(scope="module")
def slopes() -> np.ndarray:
    """[parameters, loops, points]"""
    run = jax.jit(lambda z: jax.vmap(jax.linearize(force_of, z)[1])(jnp.eye(z.size)))
    return np.asarray(run(values(VALVE)))


@pytest.mark.parametrize("spec", specs(VALVE), ids=lambda spec: spec.symbol)
def test_derivatives_meet_central_differences(spec, slopes):
    """For every parameter, on loops that all switch branch four times a cycle."""
    k = [s.symbol for s in specs(VALVE)].index(spec.symbol)
    shift = 1e-5 * spec.typical * jnp.eye(len(specs(VALVE)))[k]
    here = values(VALVE)
    expected = np.asarray(force_of(here + shift) - force_of(here - shift))
    expected = expected / (2e-5 * spec.typical)
    if spec.symbol == "tau":  # nothing at constant current
        np.testing.assert_array_equal(slopes[k], 0.0)
        return
    largest = np.abs(expected).max(axis=1, keepdims=True)
    told = largest[:, 0] > 0.0
    assert told.any()
    np.testing.assert_allclose(slopes[k] / largest.max(), expected / largest.max(), atol=1e-7)
    error = np.abs(slopes[k] - expected)[told] / largest[told]
    assert error.max() <= 1e-5


@pytest.fixture(scope="module")
def parts() -> Parts:
    return eqx.filter_jit(Lumped.parts)(VALVE, LOOPS)


def test_loops_switch_and_a_step_may_hold_a_whole_change_of_sign(parts):
    """What the derivatives above went through: the slope of χ changes by two decades each time."""
    limit = np.asarray(VALVE.element(LOOPS).yielding)
    share = np.asarray(parts.yielding) / limit
    yielded = np.abs(share) > 1 - 1e-12
    switches = (yielded != np.roll(yielded, 1, axis=1)).sum(axis=1)
    reversals = (share > 1 - 1e-12) & (np.roll(share, -1, axis=1) < -1 + 1e-12)
    assert (switches[CURRENT > 0.3] >= 4).all()
    assert reversals[CURRENT < 0.1].any()
    assert BRANCHES > 3  # and one to turn back in


def test_reverse_and_forward_derivatives_agree(slopes):
    weights = np.random.default_rng(3).standard_normal(slopes.shape[1:])
    found = jax.jit(jax.grad(lambda z: jnp.sum(force_of(z) * weights)))(values(VALVE))
    expected = (slopes * weights).sum(axis=(1, 2))
    np.testing.assert_allclose(found, expected, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("held", [(), ("stiffness",), ("stiffness", "pre", "post")])
def test_derivatives_do_not_depend_on_which_numbers_are_given_at_every_point(held):
    """All at once, while what is not held also changes along the motion."""
    once = VALVE.element(LOOPS)
    shape, wave = LOOPS.velocity.shape, jnp.sin(2.0 * np.pi * jnp.arange(POINTS) / POINTS)
    widths = {
        name: (1,) if name in held else shape[-1:]
        for name, z in once._asdict().items()
        if z is not None
    }
    factors = {
        name: 1.0 + 0.05 * (wave if width == shape[-1:] else 0.0 * wave[:1])
        for name, width in widths.items()
    }

    def force(sizes: jax.Array, everywhere: bool) -> jax.Array:
        numbers = {
            name: jnp.broadcast_to(getattr(once, name), (*shape[:-1], 1)) * factors[name] * size
            for (name, _), size in zip(widths.items(), sizes, strict=True)
        }
        if everywhere:
            numbers = {name: jnp.broadcast_to(z, shape) for name, z in numbers.items()}
        return element_force(once._replace(**numbers), LOOPS)

    one = jnp.ones(len(widths))
    few, all_ = (
        np.asarray(jax.jit(jax.jacfwd(lambda z, e=e: force(z, e)))(one)) for e in (False, True)
    )
    assert np.abs(all_).max() > 100.0
    np.testing.assert_allclose(few, all_, atol=1e-9 * np.abs(all_).max())
    shift = 1e-6 * jnp.eye(len(widths))[list(widths).index("yielding")]
    expected = np.asarray(force(one + shift, False) - force(one - shift, False)) / 2e-6
    place = list(widths).index("yielding")
    np.testing.assert_allclose(few[..., place], expected, atol=1e-4 * np.abs(expected).max())


def test_parts_are_what_the_element_says(parts):
    element = VALVE.element(LOOPS)
    force = np.asarray(simulate(VALVE, LOOPS))
    np.testing.assert_allclose(parts.total, force, atol=1e-9 * np.abs(force).max())
    share = np.asarray(parts.yielding) / np.asarray(element.yielding)
    assert np.abs(share).max() <= 1.0 + 1e-12
    fast = np.asarray(LOOPS.velocity) > 0.9 * np.asarray(LOOPS.peak_velocity)
    np.testing.assert_allclose(share[fast], 1.0, atol=1e-12)
    # at full speed the mass hardly accelerates
    viscous = np.asarray(parts.viscous)[:, 0]
    expected = np.asarray(element.post * LOOPS.peak_velocity)[:, 0]
    np.testing.assert_allclose(viscous[CURRENT < 0.1], expected[CURRENT < 0.1], rtol=0.05)


def scaled(law: str, factor: float) -> dict[str, float]:
    return {symbol: factor * value for symbol, value in TABLE_1.items() if symbol.startswith(law)}


HOT_K = 1.5e6 + 1.5e5 * 75.0
ACTING = (
    (FrequencyLaw(eps_f=0.05, part="yield"), scaled("F_y", 1.0 + 0.05 * np.log10(8.0))),
    (FrequencyLaw(eps_f=0.05, part="viscous"), scaled("C_post", 1.0 + 0.05 * np.log10(8.0))),
    (YieldTemperature(beta_y=-0.003), scaled("F_y", 1.0 - 0.003 * 35.0)),
    (ViscosityTemperature(beta_v=-0.005), scaled("C_post", np.exp(-0.005 * 35.0))),
    (StiffnessTemperature(beta_k=0.02), scaled("k", 1.0 + 0.02 * 35.0)),
    (SeriesCompliance(s_k=1e-7), scaled("k", 1.0 / (1.0 + 1e-7 * HOT_K))),
)


@pytest.mark.parametrize(("effect", "changes"), ACTING, ids=lambda z: type(z).__name__)
def test_laws_and_springs_change_the_element_and_not_its_force(effect, changes):
    """At 8 Hz and 75 °C each is exactly a change of the table."""
    found = np.asarray(simulate(Damper(VALVE, (effect,)), LOOPS))
    expected = np.asarray(simulate(lumped(**changes), LOOPS))
    here = (FREQUENCY == 8.0) & (TEMPERATURE == 75.0)
    np.testing.assert_allclose(found[here], expected[here], atol=1e-8 * np.abs(expected).max())
    changed = np.abs(expected - np.asarray(simulate(VALVE, LOOPS)))[here].max(axis=1)
    assert (changed > 1e-3 * np.abs(expected).max(axis=1)[here]).any()


def stiff_solution(row: int, compliance: float, leakage: float, friction: float) -> np.ndarray:
    """Table 1's element with a leak beside it, and viscosity beside both, behind a spring."""
    omega, k = 2 * np.pi * FREQUENCY[row], 1e3 * (1500 + 150 * TEMPERATURE[row])
    element = at(CURRENT[row], TEMPERATURE[row])
    post, limit = element["post"], element["yielding"] / (1e5 - element["post"])

    def rates(time: float, state: np.ndarray) -> list[float]:
        place, leaked, y, w = state
        force = k * (place - leaked - y)
        beside = (AMPLITUDE[row] * np.sin(omega * time) - place) / compliance - force
        chi = post * w + (1e5 - post) * np.clip(w, -limit, limit)
        return [beside / friction, leakage * force, w, (force - chi) / 2.0]

    time = (4.0 + np.arange(POINTS) / POINTS) / FREQUENCY[row]
    found = solve_ivp(
        rates, (0.0, time[-1]), np.zeros(4), method="Radau", t_eval=time, rtol=1e-7, atol=1e-10,
        max_step=1 / (100 * FREQUENCY[row]),
    )  # fmt: skip
    return (AMPLITUDE[row] * np.sin(omega * time) - found.y[0]) / compliance


def test_a_leak_and_friction_behind_a_spring_are_those_of_a_stiff_solver():
    effects = (SeriesCompliance(1e-7), BypassLeakage(1e-6), LinearViscosity(300.0))
    found = np.asarray(simulate(Damper(VALVE, effects), LOOPS))
    for row in map(int, np.flatnonzero((CURRENT == 0.4) & (FREQUENCY == 8.0))):
        expected = stiff_solution(row, 1e-7, 1e-6, 300.0)
        error = np.abs(found[row] - expected) / np.abs(expected).max()
        assert error.max() < 5e-3
        assert np.sqrt(np.mean(error**2)) < 2e-3


def test_current_acts_behind_a_lag_of_three_milliseconds():
    """At constant velocity, after a step of current that is over within one sample."""
    time = np.arange(400) / 2000.0
    v = np.full(time.size, 0.2)
    current = np.where(time < 0.1, 0.2, 0.4)
    motion = time_motion(
        time, 0.2 * time, velocity=v, acceleration=0.0 * v, current=current, temperature=75.0
    )
    element = VALVE.element(motion)
    felt = np.asarray(element.yielding)
    missing = (at(0.4, 75.0)["yielding"] - felt) / (at(0.4, 75.0)["yielding"] - felt[0])
    later = time[200:] - time[200]
    np.testing.assert_allclose(missing[:200], 1.0, atol=1e-12)
    # a straight rise over 0.5 ms comes before
    rise = 6.0 * -np.expm1(-1 / 6.0)
    np.testing.assert_allclose(missing[200:], rise * np.exp(-later / 0.003), atol=1e-9)
    force, settled = np.asarray(simulate(VALVE, motion)), felt + np.asarray(element.post) * 0.2
    np.testing.assert_allclose(force[[199, -1]], settled[[199, -1]], rtol=1e-6)
