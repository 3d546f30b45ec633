"""Rival valve models: physics, limits, accuracy against SciPy, coordinates."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sysid.effects.force.gas_spring import GasSpring
from sysid.effects.law.bypass_leakage import BypassLeakage
from sysid.effects.law.frequency_law import FrequencyLaw
from sysid.effects.law.run_drift import RunDrift
from sysid.effects.law.seating_leakage import SeatingLeakage
from sysid.effects.law.stiffness_temperature import StiffnessTemperature
from sysid.effects.law.viscosity_temperature import ViscosityTemperature
from sysid.effects.law.yield_temperature import YieldTemperature
from sysid.effects.motion.backlash import Backlash
from sysid.effects.motion.series_compliance import SeriesCompliance
from sysid.identification.families import FAMILIES, family
from sysid.models.coordinates import Reference, place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.internal_state import bouc_wen_flow, dahl_flow, follow
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import as_dict, build, specs
from tests.models.rival_examples import EXAMPLES, REFERENCE, example, in_other_units

NAMES = tuple(EXAMPLES)
LOOPS = sine_motion(
    np.array([0.0125, 0.025, 0.0025, 0.0125]), np.array([0.5, 2.5, 15.0, 5.0]),
    np.array([0.0, 0.1, 0.4, 0.3]), points=72,
)  # fmt: skip


def coordinates_of(name, reference=REFERENCE):
    kind = next(f for f in FAMILIES if f.name == name)
    return kind.coordinates(reference, kind.variants[0])


@pytest.mark.parametrize("name", NAMES)
def test_every_loop_dissipates_and_is_symmetric(name):
    force = np.asarray(simulate(example(name), LOOPS))
    power = force * np.asarray(LOOPS.velocity)
    assert (power.mean(axis=1) > 0.0).all()
    swing = force - example(name).f_0
    np.testing.assert_allclose(np.roll(swing, 36, axis=1), -swing, atol=3e-3 * np.abs(swing).max())


@pytest.mark.parametrize("name", NAMES)
def test_without_yield_force_it_is_a_viscous_ellipse(name):
    valve = example(name, alpha_a=0.0, alpha_b=0.0)
    p, s = as_dict(valve), -np.expm1(-0.5 * 0.3) / 0.5
    s = -np.expm1(-((0.3 / 0.3) ** 1.5)) if name == "carreau" else s
    motion = sine_motion(0.0125, 5.0, 0.3, points=72)
    omega = 2 * np.pi * 5.0
    if name == "modified_bouc_wen":
        c_0, c_1 = p["c_0a"] + p["c_0b"] * s, p["c_1a"] + p["c_1b"] * s
        inner = c_0 + p["k_0"] / (1j * omega)
        impedance = inner * c_1 / (inner + c_1) + p["k_1"] / (1j * omega)
    else:
        impedance = p["c_a"] + p["c_b"] * s + p.get("k_0", p.get("k")) / (1j * omega)
    velocity = 0.0125 * omega * np.exp(2j * np.pi * np.arange(72) / 72)
    expected = np.real(impedance * velocity) + p["f_0"]
    found = np.asarray(valve.force(motion))[0]
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("name", [n for n in NAMES if n != "carreau"])
def test_parts_add_up_and_only_the_yield_part_knows_the_current(name):
    valve = example(name)
    parts = valve.parts(LOOPS)
    scale = float(np.abs(valve.force(LOOPS)).max())
    gas = valve.gas_force(LOOPS)
    whole = parts.total if gas is None else parts.total + gas
    np.testing.assert_allclose(whole, valve.force(LOOPS), atol=1e-12 * scale)
    np.testing.assert_allclose(parts.yielding[0], 0.0, atol=1e-12 * scale)
    assert float(jnp.abs(parts.yielding[2]).max()) > 0.3 * scale


def test_the_ultimate_state_is_that_of_the_unnormalised_model():
    """ż = −γ|v| z|z| − βv z² + A v ends at z_u = √(A/(β+γ)): w = z/z_u ends at 1."""
    A, beta, gamma = 300.0, 2.0e6, 5.0e6
    ultimate = np.sqrt(A / (beta + gamma))
    flow = bouc_wen_flow(jnp.asarray(A / ultimate), jnp.asarray(gamma / (beta + gamma)))
    x = np.concatenate([np.linspace(0.0, 0.02, 40), np.linspace(0.02, 0.013, 20)[1:]])
    w = np.asarray(follow(flow, jnp.asarray(x), periodic=False))

    def slope(z, ahead):
        return A - gamma * ahead * z * abs(z) - beta * z * z

    z = [0.0]
    for run in np.diff(x):
        ahead = np.sign(run)
        z.append(
            solve_ivp(
                lambda _, y, s=ahead: [s * slope(y[0], s)], (0, abs(run)), [z[-1]],
                rtol=1e-10, atol=1e-14,
            ).y[0, -1]
        )  # fmt: skip
    np.testing.assert_allclose(ultimate * w, z, atol=1e-7 * ultimate)
    assert w[39] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("points", [72, 360])
def test_states_of_steady_loops_have_forgotten_their_start(points):
    """Dahl's is known: w = 1 − (1 + w_r) e^{−ρ(x + A)} on the way up, w_r = tanh ρA."""
    rho, A = 60.0, 0.0125
    motion = sine_motion(A, 1.0, 0.0, points=points)
    w = np.asarray(follow(dahl_flow(jnp.asarray(rho)), motion.displacement, periodic=True))[0]
    x, up = np.asarray(motion.displacement)[0], np.asarray(motion.velocity)[0] > 1e-12
    expected = 1.0 - (1.0 + np.tanh(rho * A)) * np.exp(-rho * (x + A))
    np.testing.assert_allclose(w[up], expected[up], atol=1e-3)


@pytest.mark.parametrize("flow", [dahl_flow(jnp.asarray(1000.0)), *(
    bouc_wen_flow(jnp.asarray(1000.0), jnp.asarray(sigma)) for sigma in (0.5, 1.0, 5.0)
)])  # fmt: skip
@pytest.mark.parametrize("reach", [1e-6, 1e-5, 1e-4, 1e-3, 0.02])
def test_steady_loops_close_however_short_the_stroke(flow, reach):
    """ρA from a thousandth to twenty: below 1 the state needs many cycles to forget its start."""
    x = sine_motion(reach, 1.0, 0.0, points=72).displacement[0]
    w = np.asarray(follow(flow, x, periodic=True))
    assert float(flow(jnp.asarray(w[-1]), x[0] - x[-1])) == pytest.approx(w[0], abs=1e-10)
    np.testing.assert_allclose(np.roll(w, 36), -w, atol=1e-10)
    rate = jax.jacfwd(lambda r: follow(dahl_flow(r), x, periodic=True))(1000.0)
    tip = float(rate[int(np.argmax(x))])
    assert tip == pytest.approx(reach / np.cosh(1000.0 * reach) ** 2, rel=1e-6, abs=1e-12)


def reference_force(p, amplitude, frequency, current, cycles=12, points=360):
    """The modified model by a stiff solver, in the source's y."""
    omega, s = 2 * np.pi * frequency, -np.expm1(-p["q"] * current) / p["q"]
    alpha = p["alpha_a"] + p["alpha_b"] * s
    c_0, c_1 = p["c_0a"] + p["c_0b"] * s, p["c_1a"] + p["c_1b"] * s

    def x(t):
        return amplitude * np.sin(omega * t)

    def y_rate(t, y, w):
        v = amplitude * omega * np.cos(omega * t)
        return (alpha * w + c_0 * v + p["k_0"] * (x(t) - y)) / (c_0 + c_1)

    def rates(t, state):
        y, w = state
        u = amplitude * omega * np.cos(omega * t) - y_rate(t, y, w)
        turn = p["sigma"] * abs(u) * w * abs(w) + (1 - p["sigma"]) * u * w * w
        return [y_rate(t, y, w), p["rho"] * (u - turn)]

    t = (np.arange(points) / points + cycles) / frequency
    state = solve_ivp(
        rates, (0, t[-1]), [0.0, 0.0], t_eval=t, method="LSODA", rtol=1e-7, atol=1e-9,
        max_step=1 / frequency / 100,
    ).y  # fmt: skip
    return c_1 * y_rate(t, *state) + p["k_1"] * x(t) + p["f_0"]


@pytest.mark.parametrize(
    ("amplitude", "frequency", "current", "changes"),
    [
        (0.0125, 5.0, 0.3, {}),
        (0.025, 0.5, 0.4, {"rho": 5000.0, "sigma": 10.0}),
        (0.0025, 12.5, 0.2, {"c_1a": 2000.0, "k_0": 20000.0}),
    ],
)
def test_modified_model_meets_a_stiff_solver_on_coarse_and_fine_grids(
    amplitude, frequency, current, changes
):
    valve = example("modified_bouc_wen", **changes)
    expected = reference_force(as_dict(valve), amplitude, frequency, current)
    limit = 5e-3 * np.abs(expected).max()
    for points in (72, 360):
        motion = sine_motion(amplitude, frequency, current, points=points)
        found = np.asarray(valve.force(motion))[0]
        np.testing.assert_allclose(found, expected[:: 360 // points], atol=limit)


@pytest.mark.parametrize("name", NAMES)
def test_loops_and_the_same_motion_in_time_agree(name):
    """Six cycles on a time grid, from rest, end in the loop."""
    rate, frequency = 180.0, 1.0
    t = np.arange(int(6 * rate) + 1) / rate
    record = time_motion(t, 0.0125 * np.sin(2 * np.pi * t), current=0.3, temperature=40.0)
    loop = sine_motion(0.0125, frequency, 0.3, points=180)
    valve = example(name, k_0=2.0e4) if name == "modified_bouc_wen" else example(name)
    ran = np.asarray(simulate(valve, record))[4 * 180 : 5 * 180]
    steady = np.asarray(simulate(valve, loop))[0]
    np.testing.assert_allclose(ran, steady, atol=0.02 * np.abs(steady).max())


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_meet_finite_differences(name):
    coordinates = coordinates_of(name)
    u = place_of(coordinates, example(name))

    @jax.jit
    def force(z):
        return coordinates.valve(z).force(LOOPS).ravel()

    slopes = np.asarray(jax.jit(jax.jacfwd(force))(u))
    step = 1e-5
    for k in range(u.size):
        shift = step * np.eye(u.size)[k]
        expected = np.asarray(force(u + shift) - force(u - shift)) / (2 * step)
        np.testing.assert_allclose(
            slopes[:, k], expected, atol=2e-3 * max(np.abs(expected).max(), 1.0)
        )


def shuffled(motion: Motion, order: np.ndarray) -> Motion:
    """The same instants in another order."""
    points = motion.displacement.shape[-1]
    return jax.tree.map(lambda z: z[..., order] if z.shape[-1] == points else z, motion)


@pytest.mark.parametrize("name", [*NAMES, "generalized"])
def test_what_is_called_memoryless_has_the_same_force_at_instants_in_any_order(name):
    generalized = build(Generalized, LOW_SYMMETRIC | {"k_1e": LOW_SYMMETRIC["k_1c"]})
    valve = generalized if name == "generalized" else example(name)
    order = np.random.default_rng(0).permutation(LOOPS.displacement.shape[-1])
    before = np.asarray(valve.force(LOOPS))[:, order]
    after = np.asarray(valve.force(shuffled(LOOPS, order)))
    same = np.allclose(after, before, rtol=0.0, atol=1e-9 * np.abs(before).max())
    assert same == type(valve).memoryless == family(name).memoryless


def test_a_yielding_mass_has_a_memory():
    assert not family("lumped").memoryless


@pytest.mark.parametrize("name", NAMES)
def test_there_and_back(name):
    coordinates = coordinates_of(name)
    u = place_of(coordinates, example(name))
    assert u.shape == (coordinates.size,) == (len(coordinates.free),)
    found = as_dict(valve_at(coordinates, u))
    assert found == pytest.approx(as_dict(example(name)), rel=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_any_numbers_give_a_model_inside_its_bounds(name):
    coordinates = coordinates_of(name)
    rng = np.random.default_rng(5)
    for scale in (0.0, 1.0, 3.0, 8.0):
        valve = valve_at(coordinates, jnp.asarray(scale * rng.standard_normal(coordinates.size)))
        for spec in specs(type(valve)):
            assert spec.check(float(getattr(valve, spec.symbol))) is None
        assert np.isfinite(np.asarray(simulate(valve, LOOPS))).all()


@pytest.mark.parametrize("name", NAMES)
def test_units_do_not_matter(name):
    """Forces × 30, lengths × 0.2 and milliamperes leave the coordinates where they are."""
    elsewhere = coordinates_of(name, Reference(600.0 * 30, 0.39 * 0.2, 0.4 * 1000, 0.025 * 0.2))
    np.testing.assert_allclose(
        place_of(coordinates_of(name), example(name)),
        place_of(elsewhere, in_other_units(name, 30.0, 0.2, 1000.0)),
        atol=1e-9,
    )


@pytest.mark.parametrize("name", ["dahl", "bouc_wen", "modified_bouc_wen"])
def test_laws_of_temperature_change_the_state_of_each_test_by_its_own(name):
    """ρ, c and α are those at its temperature; k_0 x + f_0, a gas, stays."""
    laws = (StiffnessTemperature(0.02), ViscosityTemperature(-0.01))
    warm = np.array([15.0, 40.0, 60.0])
    motion = sine_motion(np.full(3, 0.0125), 2.5, 0.3, temperature=warm, points=72)
    found = np.asarray(Damper(example(name), laws).force(motion))
    values = as_dict(example(name))
    alone = sine_motion(0.0125, 2.5, 0.3, points=72)
    for test, above in enumerate(warm - 40.0):
        changed = {"rho": values["rho"] * (1.0 + 0.02 * above)}
        idle = [z for z in ("c_a", "c_0a", "c_1a", "alpha_a") if z in values]
        changed |= {z: values[z] * float(np.exp(-0.01 * above)) for z in idle}
        expected = np.asarray(example(name, **changed).force(alone))[0]
        np.testing.assert_allclose(found[test], expected, atol=1e-7 * np.abs(expected).max())


def warm_loops(points: int = 72) -> Motion:
    motion = sine_motion(
        np.array([0.0125, 0.0025, 0.0125]), np.array([0.5, 12.0, 5.0]), np.array([0.1, 0.4, 0.2]),
        temperature=np.array([15.0, 40.0, 60.0]), points=points,
    )  # fmt: skip
    place = jnp.asarray([[0.0], [0.5], [1.0]])
    return eqx.tree_at(lambda m: m.run_share, motion, place, is_leaf=lambda z: z is None)


@pytest.mark.parametrize("effects", [
    (ViscosityTemperature(-0.01),), (YieldTemperature(-0.01), StiffnessTemperature(0.02)),
    (FrequencyLaw(0.1),), (RunDrift(0.1),), (BypassLeakage(3e-6),),
    (SeatingLeakage(2e-5, 4e-4, 1.0), ViscosityTemperature(-0.01)),
    (Backlash(2e-4), BypassLeakage(3e-6)), (Backlash(2e-4), ViscosityTemperature(-0.01)),
])  # fmt: skip
@pytest.mark.parametrize("name", NAMES)
def test_neither_laws_nor_leaks_nor_play_know_the_gas(name, effects):
    """k x + f_0 at the rod's place is added to what the valve would have without it."""
    k = "k_1" if name == "modified_bouc_wen" else "k" if name in ("tanh", "carreau") else "k_0"
    motion, gas = warm_loops(), {k: 900.0, "f_0": 290.0}
    with_gas = Damper(example(name, **gas), effects).force(motion)
    without = Damper(example(name, **dict.fromkeys(gas, 0.0)), effects).force(motion)
    expected = 900.0 * motion.displacement + 290.0
    np.testing.assert_allclose(with_gas - without, expected, atol=1e-6)


@pytest.mark.parametrize("name", ["tanh", "carreau"])
def test_a_leak_is_driven_by_the_pressure_over_the_piston_alone(name):
    """w = v − κ F(w), F without k x + f_0, by bisection."""
    leak, motion = 3e-6, sine_motion(0.0125, 2.5, 0.2, points=36)
    valve, plain = example(name, k=900.0, f_0=290.0), example(name, k=0.0, f_0=0.0)

    @jax.jit
    def oil(w):
        return plain.force(eqx.tree_at(lambda m: m.velocity, motion, w))

    v = np.asarray(motion.velocity)
    low, high = v - 0.1, v + 0.1
    for _ in range(60):
        middle = 0.5 * (low + high)
        over = middle + leak * np.asarray(oil(middle)) > v
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    expected = np.asarray(oil(low)) + 900.0 * np.asarray(motion.displacement) + 290.0
    found = Damper(valve, (BypassLeakage(leak),)).force(motion)
    np.testing.assert_allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("name", ["tanh", "carreau"])
def test_behind_a_spring_the_gas_is_the_one_of_the_catalogue(name):
    """The model's k x is a gas spring beside the valve, a leak at the valve or none."""
    for beside in ((), (BypassLeakage(3e-6),), (ViscosityTemperature(-0.01),)):
        effects, motion = (SeriesCompliance(2e-7), *beside), warm_loops()
        own = Damper(example(name, k=2000.0), effects).force(motion)
        added = Damper(example(name, k=0.0), (*effects, GasSpring(2000.0))).force(motion)
        np.testing.assert_allclose(own, added, atol=1e-6)


@pytest.mark.parametrize("name", [*NAMES, "generalized"])
def test_a_damper_without_effects_is_its_valve_to_the_last_bit(name):
    generalized = build(Generalized, LOW_SYMMETRIC | {"k_1e": LOW_SYMMETRIC["k_1c"]})
    valve = generalized if name == "generalized" else example(name)
    assert np.array_equal(Damper(valve).force(LOOPS), valve.force(LOOPS))
