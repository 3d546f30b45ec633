"""Planters against closed forms of the physics that they are made of."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sysid.models.generalized import LOW_SYMMETRIC
from sysid.rig.damper import HystereticDamper
from sysid.rig.excitation import State
from sysid.rig.planters.backlash import LoosePin, RodPlay
from sysid.rig.planters.bench_state import steady_bench
from sysid.rig.planters.bump_stop import RubberStop
from sysid.rig.planters.fluid_inertia import OilColumn
from sysid.rig.planters.fluid_law import RelaxingChains, VogelOil, WarmParticles, vogel_ratio
from sysid.rig.planters.force_channel import ButterworthChannel, ConverterLimit, LateSampling
from sysid.rig.planters.gas_chamber import BalancedGasChamber, GasChamber, LargeGasChamber
from sysid.rig.planters.gas_pocket import GasPocket
from sysid.rig.planters.history import HeatedOil, SettledParticles, WornGap
from sysid.rig.planters.lugre import lugre_force
from sysid.rig.planters.magnet import EddyCurrents, Remanence
from sysid.rig.planters.oil_flow import LeakingPiston, Orifice, slot_wall_stress
from sysid.rig.planters.periodic import shifted
from sysid.rig.planters.rod_friction import BreakawaySeal, SoftSeal
from sysid.rig.planters.roots import rising_root
from sysid.rig.planters.soft_mount import SoftMount
from sysid.rig.planters.valve import BoucWenValve, HystereticValve
from tests.rig.bench_states import PHASE, Dashpot, Signal, added, one


def test_the_valve_is_the_laboratory_s_damper():
    state = one(12.5e-3, 1.5, 0.3)
    own = HystereticDamper(LOW_SYMMETRIC).force(
        State(state.displacement[0], state.velocity[0], state.side[0],
              np.full(720, state.peak_velocity[0, 0])),
        0.3,
    )  # fmt: skip
    np.testing.assert_allclose(state.force[0], own, rtol=0, atol=1e-8)


def test_bouc_wen_yields_after_its_travel_and_saturates():
    valve = BoucWenValve(np.full((1, 1), 1.0 / 720), viscosity=(0.0, 0.0))
    state = one(20e-3, 1.0, 0.4, valve)
    strength = 110.0 + 900.0 * math.tanh(1.6)
    assert np.max(state.force) == pytest.approx(strength, rel=1e-6)
    back = state.travel_since_reversal[0]
    unloading = (state.velocity[0] < 0.0) & (back < 0.5e-3)
    expected = strength * (1.0 - back[unloading] / valve.yield_travel)
    np.testing.assert_allclose(state.force[0, unloading], expected, rtol=0, atol=2.0)


def test_adiabatic_stiffness_of_a_gas_chamber():
    chamber = GasChamber(heat_time=1e3)
    stiffness = 1.4 * chamber.size * chamber.rod_area**2 / chamber.volume
    state = one(0.2e-3, 5.0)
    np.testing.assert_allclose(
        added(chamber, state), stiffness * state.displacement[0], rtol=0, atol=3e-3 * 0.28
    )


def test_slow_strokes_of_a_gas_chamber_are_isothermal():
    chamber = GasChamber(heat_time=1e-6)
    state = one(50e-3, 0.1)
    volume = chamber.volume - chamber.rod_area * state.displacement[0]
    boyle = chamber.size * chamber.rod_area * (chamber.volume / volume - 1.0)
    np.testing.assert_allclose(added(chamber, state), boyle, rtol=1e-6, atol=1e-6)


def test_gas_work_over_a_cycle_is_nothing():
    for chamber in (GasChamber(), LargeGasChamber(), BalancedGasChamber()):
        state = one(50e-3, 0.5)
        work = np.mean(added(chamber, state) * state.velocity[0])
        assert abs(work) < 1e-9 * np.max(np.abs(added(chamber, state)))


def test_oil_column_is_a_mass():
    column = OilColumn()
    state = one(2.5e-3, 15.0)
    mass = 3000.0 * 0.03 * 1.2e-3**2 / 8.0e-5
    np.testing.assert_allclose(added(column, state), mass * state.acceleration[0], atol=1e-9)
    assert 0.5 < mass < 3.0


def test_lugre_slides_at_its_slip_force_and_starts_like_a_spring():
    state = one(10e-3, 0.5)
    friction = lugre_force(state, np.full((1, 1), 30.0), 1e5)[0]
    fast = np.abs(state.velocity[0]) > 0.9 * state.peak_velocity[0, 0]
    np.testing.assert_allclose(
        friction[fast], 30.0 * np.sign(state.velocity[0, fast]), rtol=0, atol=1e-6
    )
    travel = state.travel_since_reversal[0]
    inwards = state.velocity[0] > 1e-9
    bristles = 30.0 * (1.0 - 2.0 * np.exp(-1e5 * travel[inwards] / 30.0))
    np.testing.assert_allclose(friction[inwards], bristles, rtol=0, atol=1e-6)
    work = np.mean(friction * state.velocity[0]) / 0.5
    assert 0.9 * 4 * 30.0 * 10e-3 < work < 4 * 30.0 * 10e-3


def test_presliding_does_not_depend_on_the_rate():
    slow, fast = (added(SoftSeal(), one(1e-3, f)) for f in (0.1, 10.0))
    np.testing.assert_allclose(slow, fast, rtol=0, atol=1e-6)


def test_breakaway_falls_with_speed_as_stribeck_has_it():
    seal = BreakawaySeal()
    state = one(12.5e-3, 0.1)
    v = state.velocity[0]
    well_after = state.travel_since_reversal[0] > 1e-3
    expected = seal.size * np.exp(-((v / seal.film_speed) ** 2)) * np.sign(v)
    np.testing.assert_allclose(
        added(seal, state)[well_after], expected[well_after], rtol=0, atol=0.2
    )


def test_soft_mount_before_a_dashpot_is_a_first_order_lag():
    c, s = 2000.0, 1e-6
    state = one(5e-3, 8.0, valve=Dashpot(c))
    wave = np.exp(1j * PHASE) / (1.0 + 1j * 2.0 * np.pi * 8.0 * c * s)
    expected = c * state.peak_velocity[0, 0] * wave.real
    got = SoftMount(size=s).plant(state).force[0]
    np.testing.assert_allclose(got, expected, rtol=0, atol=1.5e-3 * np.max(expected))


def test_travel_of_the_mount_is_the_force_over_its_stiffness():
    state = one(2.5e-3, 5.0, 0.3)
    planted = SoftMount(size=1e-7).plant(state)
    valve = np.cumsum(planted.valve_velocity[0]) * state.time_step[0]
    rod = np.cumsum(state.velocity[0]) * state.time_step[0]
    lost = np.ptp(rod) - np.ptp(valve)
    ends = [np.argmax(valve), np.argmin(valve)]
    assert np.ptp(state.displacement[0] - planted.force[0] * 1e-7) == pytest.approx(
        np.ptp(valve), rel=2e-3
    )
    carried = np.ptp(planted.force[0, ends]) * 1e-7
    assert -carried < lost < np.ptp(planted.force[0]) * 1e-7


def test_play_keeps_the_piston_standing_for_the_gap():
    gap = 0.5e-3
    state = one(2.5e-3, 2.5)
    planted = RodPlay(size=gap).plant(state)
    piston = np.cumsum(planted.valve_velocity[0]) * state.time_step[0]
    assert np.ptp(state.displacement[0]) - np.ptp(piston) == pytest.approx(gap, rel=0.02)
    crossing = state.travel_since_reversal[0] < 0.98 * gap
    assert np.all(planted.valve_velocity[0, crossing] == 0.0)


def test_behind_a_play_the_force_is_a_mean_but_that_of_a_valve_with_a_memory():
    """About the point at which the piston starts: of rest and motion, whatever lies between."""
    state, play = one(2.5e-3, 2.5, 0.4), RodPlay(size=0.5e-3)
    planted = play.plant(state)
    speed = np.divide(planted.valve_velocity, state.velocity,
                      out=np.zeros_like(state.velocity), where=state.velocity != 0.0)  # fmt: skip
    starts = (speed > 0.05) & (speed < 0.95)
    assert starts.any()
    moving, resting = state.valve_force(), state.valve_force(velocity=0.0 * state.velocity)
    expected = speed * moving + (1.0 - speed) * resting
    np.testing.assert_allclose(planted.force[starts], expected[starts], rtol=1e-9)
    old = one(2.5e-3, 2.5, 0.4, BoucWenValve(np.full((1, 1), 0.4 / 720)))
    remembered = play.plant(old)
    np.testing.assert_array_equal(remembered.force, remembered.valve_force())


def lifted(points: int) -> tuple[float, float]:
    """Travel at which a loose pin's force has come to zero on the way in, and a step there, m."""
    state = one(12.5e-3, 2.5, points=points)
    into = (state.velocity > 0.0) & (state.force * state.velocity > 0.0)
    travel = float(LoosePin().lifting(state)[into].min())
    first = np.argmin(np.where(into, state.travel_since_reversal, np.inf))
    return travel, float(state.velocity.flat[first] * state.time_step[0])


@pytest.mark.parametrize("points", [360, 720])
def test_a_loose_pin_lifts_where_its_force_is_gone_not_at_the_next_point(points):
    """A gap that is counted from the next point on is half a step too long on the average."""
    (here, step), (exact, _) = lifted(points), lifted(23040)
    assert here == pytest.approx(exact, abs=0.1 * step)


def test_loose_pin_carries_nothing_over_the_gap_and_all_of_it_elsewhere():
    gap = 0.5e-3
    state = one(12.5e-3, 2.5, points=7200)
    force = LoosePin(size=gap).plant(state).force[0]
    for stroke in (state.velocity[0] > 0.0, state.velocity[0] < 0.0):
        free = stroke & (force == 0.0)
        assert np.ptp(state.displacement[0, free]) == pytest.approx(gap, rel=0.02)
    carrying = force != 0.0
    share = np.isclose(force[carrying], state.force[0, carrying])
    assert np.mean(share) > 0.99


def test_gas_pocket_is_closed_as_far_as_its_pressure_asks():
    pocket = GasPocket(size=0.2e-3)
    state = one(12.5e-3, 0.5, 0.3)
    planted = pocket.plant(state)
    half = slice(541, 720)
    lost = np.sum(state.velocity[0, half] - planted.valve_velocity[0, half]) * state.time_step[0]
    rest = state.valve_force(velocity=np.zeros_like(state.velocity))[0, 540]
    high = 1.0 + (planted.force[0, 719] - rest) / pocket.pocket_force
    assert lost == pytest.approx(0.2e-3 * (1.0 - high ** (-1.0 / 1.2)), rel=0.03)
    out = state.velocity[0] < 0.0
    np.testing.assert_array_equal(planted.force[0, out], state.force[0, out])


def test_newtonian_limit_of_slot_flow():
    flow = np.linspace(0.0, 1e-4, 30)
    stress = slot_wall_stress(flow, 0.11, 1e-3, 0.08, 1.0, 0.0)
    np.testing.assert_allclose(stress, 6.0 * 0.08 * flow / (0.11 * 1e-6), rtol=2e-4)


@pytest.mark.parametrize("index", [0.5, 0.8])
def test_power_law_limit_of_slot_flow(index: float):
    flow = np.geomspace(1e-6, 1e-4, 30)
    rate = (2.0 + 4.0 * index) / index * flow / (0.11 * 1e-6)
    stress = slot_wall_stress(flow, 0.11, 1e-3, 1.5, index, 0.0)
    np.testing.assert_allclose(stress, 1.5 * rate**index, rtol=2e-4)


def test_plug_flow_limit_of_slot_flow():
    slow = slot_wall_stress(np.array([0.0, 1e-12]), 0.11, 1e-3, 0.08, 1.0, 500.0)
    np.testing.assert_allclose(slow, 500.0, rtol=2e-3)
    flow = np.array([1e-5])
    plastic = slot_wall_stress(flow, 0.11, 1e-3, 0.08, 1.0, 500.0)
    ratio = 500.0 / plastic
    buckingham = 0.11 * 1e-6 * plastic / (6.0 * 0.08) * (1.0 - 1.5 * ratio + 0.5 * ratio**3)
    np.testing.assert_allclose(buckingham, flow, rtol=1e-3)


def test_orifice_is_bernoulli_s():
    hole = Orifice()
    state = one(25e-3, 2.5)
    jet = 0.2 * hole.piston_area / hole.hole_area
    at = np.interp(0.2, state.velocity[0, 540:], added(hole, state)[540:])
    assert at == pytest.approx(0.5 * hole.size * jet**2 * hole.piston_area, rel=1e-3)


def test_leak_beside_a_dashpot():
    c, leak = 3000.0, 2e-5
    state = one(5e-3, 2.0, valve=Dashpot(c))
    got = LeakingPiston(size=leak).plant(state).force
    np.testing.assert_allclose(got, state.force / (1.0 + c * leak), rtol=1e-6, atol=1e-6)


def test_delay_turns_the_phase():
    state = one(2.5e-3, 10.0, valve=Signal(np.sin(PHASE)))
    late = LateSampling(size=1e-3).plant(state).force[0]
    np.testing.assert_allclose(late, np.sin(PHASE - 2.0 * np.pi * 10.0 * 1e-3), atol=1e-8)
    whole = shifted(state.force, np.array([3.0]))
    np.testing.assert_allclose(whole[0], np.roll(state.force[0], 3), atol=1e-15)


def test_butterworth_gain_and_phase():
    cut = 40.0
    for f in (5.0, 40.0, 120.0):
        state = one(1e-3, f, valve=Signal(np.cos(PHASE)))
        out = ButterworthChannel(size=1.0 / (2.0 * np.pi * cut)).plant(state).force[0]
        first = 2.0 * np.mean(out * np.exp(-1j * PHASE))
        assert abs(first) == pytest.approx(1.0 / math.sqrt(1.0 + (f / cut) ** 4), rel=1e-9)
        if f == cut:
            assert np.angle(first) == pytest.approx(-np.pi / 2.0)


def test_converter_cuts_at_its_range():
    state = one(12.5e-3, 2.5, 0.4)
    force = ConverterLimit(size=0.1).plant(state).force
    assert np.max(force) == pytest.approx(0.9 * np.max(state.force), rel=1e-12)
    inside = np.abs(state.force) < 0.89 * np.max(state.force)
    assert np.array_equal(force[inside], state.force[inside])


def test_vogel_slope_and_curvature():
    around = vogel_ratio(np.array([39.0, 40.0, 41.0]), 5e-3)
    assert around[1] == 1.0
    assert math.log(around[2] / around[0]) / 2.0 == pytest.approx(-5e-3, rel=1e-3)
    far = vogel_ratio(np.array([15.0, 65.0]), 5e-3)
    assert -math.log(far[1]) < math.log(far[0])


def test_viscosity_acts_without_field_and_yield_only_with_it():
    state = replace(one(12.5e-3, 1.5, 0.3), temperature=np.array([50.0]))
    oil = VogelOil(size=5e-3).plant(state).force
    ratio = vogel_ratio(np.array([50.0]), 5e-3)
    np.testing.assert_allclose(oil - state.force, (ratio - 1.0) * state.fluid_part(), atol=1e-9)
    chains = WarmParticles(size=3e-3).plant(state).force
    share = (chains - state.fluid_part()) / state.field_part()
    np.testing.assert_allclose(share, math.exp(-0.03), rtol=2e-3)


def test_relaxing_chains_grow_with_the_logarithm_of_frequency():
    chains = RelaxingChains()
    rise = np.diff(chains.modulus(np.array([0.1, 0.3, 1.0, 3.0, 10.0])))
    assert np.all(rise > 0.0)
    assert np.max(rise) / np.min(rise) < 1.5
    assert chains.modulus(np.array([1e9]))[0] == pytest.approx(1.0 + chains.size, rel=1e-3)


def test_eddy_currents_halve_the_field_at_their_speed():
    state = one(25e-3, 2.5, 0.3)
    speed = state.peak_velocity[0, 0]
    planted = EddyCurrents(size=1.0 / speed).plant(state)
    lost = planted.force[0, 0] - state.force[0, 0]
    assert lost == pytest.approx(-0.5 * state.field_part()[0, 0])


def test_remanence_follows_the_order_of_the_currents():
    current = np.array([0.0, 0.4, 0.2, 0.2])
    bench = steady_bench(
        HystereticValve(LOW_SYMMETRIC), np.full(4, 12.5e-3), np.full(4, 1.5), current,
        run_order=np.array([1, 3, 2, 4]),
    )  # fmt: skip
    planted = Remanence(size=0.02).plant(bench)
    np.testing.assert_allclose(planted.valve_current[:, 0], [0.0, 0.38, 0.18, 0.22])
    assert np.max(planted.force[2]) < np.max(bench.force[2]) < np.max(planted.force[3])


def test_heating_balances_energy():
    state = one(12.5e-3, 2.5, 0.3)
    heated = HeatedOil(size=1e-3, loss=1e-9)
    rise = heated.rise(state)[0]
    work = np.mean(state.force * state.velocity) / 2.5
    assert rise[1, 0] - rise[0, 0] == pytest.approx(1e-3 * work, rel=1e-6)
    departures = heated.plant(state).departures
    assert departures is not None
    assert np.max(np.abs(departures.mean(axis=1))) < 1e-9
    strength = np.mean(departures[0] * np.sign(state.velocity[0]), axis=1)
    assert np.all(np.diff(strength) < 0.0)


def test_stirring_fades_from_cycle_to_cycle():
    state = one(12.5e-3, 2.5)
    settled = SettledParticles(size=50.0, stirring=2.0)
    planted = settled.plant(state)
    assert planted.departures is not None
    cycles = planted.departures[0] + added(settled, state)
    level = np.mean(cycles * np.sign(state.velocity[0]), axis=1)
    np.testing.assert_allclose(level[1:] / level[:-1], math.exp(-0.5), rtol=1e-6)
    assert np.max(cycles) == pytest.approx(50.0, rel=0.02)


def test_wear_grows_with_the_work_done_before():
    bench = steady_bench(
        HystereticValve(LOW_SYMMETRIC), np.full(3, 12.5e-3), np.full(3, 1.5),
        np.array([0.4, 0.0, 0.2]), run_order=np.array([2, 1, 3]),
    )  # fmt: skip
    left = WornGap(size=0.1).plant(bench).force / bench.force
    power = np.mean(bench.force * bench.velocity, axis=1)
    assert left[1] == pytest.approx(1.0)
    assert left[0] == pytest.approx(1.0 - 0.1 * power[1] / power.sum())
    assert left[2] == pytest.approx(1.0 - 0.1 * (power[1] + power[0]) / power.sum())


def test_stop_is_felt_near_the_ends_only():
    bench = steady_bench(
        HystereticValve(LOW_SYMMETRIC), np.array([0.05, 0.075]), np.full(2, 0.5), np.zeros(2)
    )
    stop = RubberStop(size=40.0)
    force = stop.plant(bench).force - bench.force
    assert np.all(force[0] == 0.0)
    assert np.all(force[1, np.abs(bench.displacement[1]) < 0.06] == 0.0)
    assert np.max(force[1]) == pytest.approx(40.0 * math.expm1(0.2 / 0.12))


def test_roots_of_rising_functions():
    target = np.linspace(-3.0, 3.0, 41)
    root = rising_root(lambda z: np.tanh(40.0 * z) + 0.1 * z - target, target * 0 - 40.0,
                       target * 0 + 40.0)  # fmt: skip
    np.testing.assert_allclose(np.tanh(40.0 * root) + 0.1 * root, target, atol=1e-6)
    assert rising_root(lambda z: z + 5.0, np.zeros(1), np.ones(1))[0] == 0.0
