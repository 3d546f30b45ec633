"""Play, air and leaks that close with travel: where and for how long force is missing."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from sysid.effects.base import Parts, ValveParts
from sysid.effects.force.fluid_inertia import FluidInertia
from sysid.effects.fourier import refined
from sysid.effects.law.bypass_leakage import BypassLeakage
from sysid.effects.law.seating_leakage import SeatingLeakage
from sysid.effects.leak import parts_beside_leak
from sysid.effects.motion.backlash import Backlash
from sysid.effects.motion.entrained_air import EntrainedAir
from sysid.effects.travel import travelled
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build
from tests.models.rival_examples import example

A = 0.01
POINTS = 720
LOOP = sine_motion(A, 1.0, 0.5, points=POINTS)
X, V = np.asarray(LOOP.displacement)[0], np.asarray(LOOP.velocity)[0]
TRAVEL = np.where(V > 0, X + A, A - X)
"""Since the last reversal."""
AWAY = np.abs(V) > 1e-6 * A
"""From the samples that lie on a reversal, half of which belongs to either stroke."""


def standing(motion: Motion) -> np.ndarray:
    return np.abs(np.asarray(motion.velocity)[0]) < 1e-9


@pytest.mark.parametrize("gap", [2e-4, 1e-3])
def test_backlash_holds_the_valve_after_both_reversals(gap):
    inner = Backlash(gap).at_valve(LOOP, lambda m: m.velocity)
    step = np.abs(V) / POINTS + 1e-6
    assert standing(inner)[(gap - step > TRAVEL) & AWAY].all()
    moving = (gap + step < TRAVEL) & AWAY
    np.testing.assert_allclose(np.asarray(inner.velocity)[0][moving], V[moving], rtol=1e-12)


@pytest.mark.parametrize("causal", [False, True])
@pytest.mark.parametrize("begin", ["moving", "from rest", "after a pause"])
def test_what_begins_to_move_has_its_play_used_up(causal, begin):
    """On the first way nothing is missing, on the way back the gap is."""
    t, gap = np.arange(1000) / 1000.0, 4e-4
    way = np.sin(2 * np.pi * t) if begin == "moving" else 1.0 - np.cos(2 * np.pi * t)
    x = -A * (np.r_[np.zeros(200), way[:-200]] if begin == "after a pause" else way)
    motion = time_motion(t, x, current=0.2, causal=causal)
    steps = travelled(motion, jnp.asarray(gap))
    turn = int(np.argmin(x))
    moved = np.abs(np.asarray(steps.moved)) > 0.0
    before = np.asarray(steps.before)
    np.testing.assert_allclose(before[: turn + 1][moved[: turn + 1]], gap, rtol=1e-12)
    assert before[turn + 1] == pytest.approx(0.0, abs=1e-12)
    held = Backlash(gap).at_valve(motion, lambda m: m.velocity)
    np.testing.assert_allclose(held.velocity[:turn], motion.velocity[:turn], rtol=1e-12)


def test_the_missing_travel_is_the_gap_at_any_sampling():
    """∫|v − v_v| dt over a cycle is 2 δ, also where δ is less than a sample's travel.

    But for half of the first step after a reversal, which counts for the sample at the reversal.
    """
    for points in (72, 360):
        motion = sine_motion(A, 1.0, 0.5, points=points)
        beside = 0.5 * A * (1.0 - np.cos(2 * np.pi / points))
        for gap in (3e-5, 1.7e-4, 8e-4):
            inner = Backlash(gap).at_valve(motion, lambda m: m.velocity)
            missing = jnp.sum(jnp.abs(motion.velocity - inner.velocity)) / points
            assert float(missing) == pytest.approx(2 * gap, rel=0.01, abs=2 * beside)


def test_a_mass_behind_play_keeps_its_momentum():
    """∫ m a dt from reversal to reversal is m times the change of the rod's speed all the same."""
    mass, stroke = FluidInertia(jnp.asarray(2.0)), V > 1e-6 * A
    alone, behind = (
        np.asarray(Damper(W11, (*gap, mass)).force(LOOP) - Damper(W11, gap).force(LOOP))[0]
        for gap in ((), (Backlash(jnp.asarray(4e-4)),))
    )
    np.testing.assert_allclose(behind[stroke].sum(), alone[stroke].sum(), atol=1e-9)
    np.testing.assert_allclose(np.abs(behind).sum(), np.abs(alone).sum(), rtol=1e-9)


LATE = 0.2
"""rad by which the force of `lagging` follows velocity: in contact for a while after reversal."""


def lagging(motion: Motion) -> jnp.ndarray:
    peak = jnp.max(jnp.abs(motion.velocity), axis=-1, keepdims=True)
    return 100.0 * (
        jnp.cos(LATE) * motion.velocity / peak + jnp.sin(LATE) * motion.displacement / A
    )


def test_a_loose_pin_stays_in_contact_until_the_force_is_gone_and_then_carries_none():
    gap = 4e-4
    force = lagging(LOOP)
    through = np.asarray(Backlash(gap, joint="loose").carried(force, LOOP))[0]
    lift = A * (1.0 - np.cos(LATE))
    step = np.abs(V) / POINTS + 1e-6
    free = (lift + step < TRAVEL) & (lift + gap - step > TRAVEL)
    assert free.sum() > 4
    assert np.abs(through[free]).max() < 1e-9
    carried = (lift - step > TRAVEL) | (lift + gap + step < TRAVEL)
    np.testing.assert_allclose(through[carried], np.asarray(force)[0][carried], rtol=1e-12)


@pytest.mark.parametrize("points", [72, 360])
def test_a_loose_pin_does_no_work_over_its_gap(points):
    """Of a friction force F the work 4 A F of a cycle falls by 2 δ F."""
    motion = sine_motion(A, 1.0, 0.5, points=points)
    friction = 100.0 * jnp.sign(motion.velocity)
    for gap in (1.7e-4, 8e-4):
        through = Backlash(gap, joint="loose").carried(friction, motion)
        missing = jnp.sum((friction - through) * motion.velocity) / points
        beside = 0.5 * A * (1.0 - np.cos(2 * np.pi / points))
        assert float(missing) == pytest.approx(200.0 * gap, rel=0.01, abs=200.0 * beside)


def test_a_loose_pin_s_gap_has_a_derivative_at_any_place_between_samples():
    force = lagging(LOOP)

    def carried(gap: jnp.ndarray) -> jnp.ndarray:
        return Backlash(gap, joint="loose").carried(force, LOOP)

    for gap in (1e-4, 4.03e-4):
        slope = jax.jacfwd(carried)(jnp.asarray(gap))
        ahead, behind = (carried(jnp.asarray(gap + h)) for h in (1e-9, -1e-9))
        np.testing.assert_allclose(slope, (ahead - behind) / 2e-9, rtol=1e-4, atol=1.0)
        assert jnp.abs(slope).max() > 1e4


W11 = build(Generalized, LOW_SYMMETRIC | {"k_1e": LOW_SYMMETRIC["k_1c"]})
FINE = 32
"""Points of a continuous loop for one that is kept."""


def kept(gap: float, amplitude: float, frequency: float) -> np.ndarray:
    """Means about 360 points of the force behind a gap, its valve at rest or in motion."""
    motion = sine_motion(amplitude, frequency, 0.4, points=360 * FINE)
    v, x = motion.velocity, motion.displacement
    travel = jnp.where(v > 0.0, amplitude + x, amplitude - x)
    resting = eqx.tree_at(lambda m: m.velocity, motion, 0.0 * v)
    force = np.asarray(jnp.where(travel < gap, W11.force(resting), W11.force(motion)))[0]
    weight = np.full(FINE + 1, 1.0 / FINE)
    weight[[0, -1]] /= 2.0
    around = np.arange(-FINE // 2, FINE // 2 + 1)
    return sum(w * np.roll(force, -k)[::FINE] for w, k in zip(weight, around, strict=True))


@pytest.mark.parametrize("gap", [1.2e-5, 6.8e-5])
@pytest.mark.parametrize(("amplitude", "frequency"), [(2.5e-3, 5.0), (12.5e-3, 2.5)])
def test_a_loop_holds_means_of_the_force_where_a_valve_starts_between_two_points(
    amplitude, frequency, gap
):
    """With the force at the mean velocity gaps were found 1.1 and 3.5 % too small.

    With straight steps, and the force of a part of a step taken at its point, 1 % too large.
    """
    motion = sine_motion(amplitude, frequency, 0.4)
    measured = kept(gap, amplitude, frequency)

    def left(part: float) -> float:
        damper = Damper(W11, (Backlash(jnp.asarray(part * gap)),))
        return float(np.sum((np.asarray(damper.force(motion))[0] - measured) ** 2))

    found = minimize_scalar(left, bounds=(0.9, 1.1), method="bounded", options={"xatol": 1e-4})
    assert found.x == pytest.approx(1.0, abs=0.004)


@pytest.mark.parametrize("effect", [Backlash(2e-4), EntrainedAir(3e-4, side=1)])
@pytest.mark.parametrize("leak", [BypassLeakage(0.0), SeatingLeakage(1e-13, 4e-4, 1.0)])
@pytest.mark.parametrize("valve", ["generalized", "tanh", "carreau"])
def test_a_leak_of_no_size_behind_a_gap_changes_nothing(valve, leak, effect):
    """Means of the forces at rest and in motion, also where a leak is searched for."""
    inner = W11 if valve == "generalized" else example(valve)
    motion = sine_motion(A, 1.0, 0.3, points=72)
    alone = np.asarray(Damper(inner, (effect,)).force(motion))
    beside = np.asarray(Damper(inner, (effect, leak)).force(motion))
    np.testing.assert_allclose(beside, alone, atol=1e-6 * np.abs(alone).max())


@pytest.mark.parametrize("name", ["dahl", "bouc_wen", "modified_bouc_wen"])
def test_a_valve_with_a_memory_follows_the_mean_motion_behind_a_gap(name):
    """Asked for its force at rest, its state would be that of a motion that never was."""
    valve, play = example(name), Backlash(jnp.asarray(4e-4))
    motion = sine_motion(A, 1.0, 0.5, points=72)
    inner = play.at_valve(motion, valve.force)
    assert (jnp.abs(inner.share - jnp.round(inner.share)) > 0.05).any(), "a point in between"
    behind = Damper(valve, (play,)).force(motion)
    np.testing.assert_allclose(behind, valve.force(inner), rtol=1e-12)


def test_only_a_gap_in_a_cycle_knows_its_share_of_the_time():
    held = Backlash(2e-4).at_valve(LOOP, lambda m: m.velocity)
    assert held.share is not None
    assert refined(held, 2).share is None
    assert held.moved(held.displacement, held.velocity, held.acceleration).share is None
    record = time_motion(np.asarray(LOOP.time)[0], X, velocity=V, acceleration=0.0 * X, current=0.0)
    assert Backlash(2e-4).at_valve(record, lambda m: m.velocity).share is None


@pytest.mark.parametrize("side", [1, -1])
def test_air_acts_on_one_side(side):
    inner = EntrainedAir(1e-3, side=side).at_valve(LOOP, lambda m: m.velocity)
    lost = standing(inner) & (np.abs(V) > 1e-3)
    assert lost.any()
    assert (V[lost] * side > 0).all()
    assert np.array_equal(inner.displacement, LOOP.displacement)


STIFF = 1e7
"""N·s/m, below a force of 10 kN a A: what fluid passes beside it does not move it."""


def stiff_valve(motion: Motion) -> Parts:
    force = jnp.clip(STIFF * motion.velocity, -1e4 * motion.current, 1e4 * motion.current)
    return Parts(yielding=force, viscous=0.0 * force)


def leaking(
    frequency: float, current: float, k_s: float, gap: float, abruptness: float = 1.0
) -> np.ndarray:
    motion = sine_motion(A, frequency, current, points=POINTS)
    return np.asarray(
        SeatingLeakage(k_s, gap, abruptness).parts(motion, ValveParts(stiff_valve)).total
    )[0]


def mean_leak(k_s: float, gap: float) -> np.ndarray:
    """k over the steps on both sides of a sample, from travel alone."""
    ends = np.stack([np.roll(X, 1), X, np.roll(X, -1)])
    travel = np.where(V > 0, ends + A, A - ends)
    open_ = np.minimum(np.maximum(travel, 0.0), gap)
    area = k_s * (open_ - 0.5 * open_**2 / gap)
    return 0.5 * np.sum(np.diff(area, axis=0) / np.diff(travel, axis=0), axis=0)


@pytest.mark.parametrize("frequency", [0.2, 1.0])
def test_shelf_of_a_leak_grows_with_speed_and_no_current_changes_it(frequency):
    """F = v/k(T) while the gap is open: what a stiff valve at high yield lets pass is all."""
    k_s, gap = 5e-5, 1e-3
    shelf = (0.7 * gap > TRAVEL) & (0.02 * gap < TRAVEL)
    assert shelf.sum() > 60
    expected = frequency * V[shelf] / mean_leak(k_s, gap)[shelf]
    for current in (0.5, 1.0):
        found = leaking(frequency, current, k_s, gap)[shelf]
        np.testing.assert_allclose(found, expected, rtol=0.02)
        assert np.abs(found).max() < 1e4 * current


def test_leak_ends_after_the_same_travel_at_every_frequency():
    """The valve alone behind the gap, exactly; less force than that in every sample before it."""
    gap = 8e-4
    one_step = np.abs(V) / POINTS + 1e-6
    seated = (gap + one_step < TRAVEL) & AWAY
    open_ = (gap - one_step > TRAVEL) & AWAY
    for frequency in (0.1, 1.0, 10.0):
        motion = sine_motion(A, frequency, 1.0, points=POINTS)
        alone = np.asarray(stiff_valve(motion).total)[0]
        force = leaking(frequency, 1.0, 1e-3, gap)
        assert np.array_equal(force[seated], alone[seated])
        assert (np.abs(force) < np.abs(alone))[open_].all()


def test_strokes_shorter_than_two_gaps_open_the_leak_at_both_ends():
    """Of 1.5 gaps each: the ring comes to its seat on either side, and T starts at 0 at both."""
    gap, k_s = 4e-4, 5e-5
    motion = sine_motion(0.75 * gap, 1.0, 0.5, points=POINTS)
    x, v = np.asarray(motion.displacement)[0], np.asarray(motion.velocity)[0]
    travel = np.where(v > 0, x + 0.75 * gap, 0.75 * gap - x)
    expected = k_s * np.maximum(1.0 - travel / gap, 0.0)
    away = np.abs(v) > 0.05 * np.abs(v).max()
    leak = np.asarray(SeatingLeakage(k_s, gap, 1.0).leakage(motion))[0]
    np.testing.assert_allclose(leak[away], expected[away], atol=1e-3 * k_s)
    np.testing.assert_allclose(leak, np.roll(leak, POINTS // 2), atol=1e-9 * k_s)


def test_a_ring_that_turns_back_on_its_seat_comes_off_it_by_as_much():
    """Seated, 0.3 gaps back, then on again: 0.3 gaps open the leak by 0.3, whatever came before."""
    gap, k_s = 4e-4, 5e-5
    x = gap * np.concatenate([np.linspace(0.0, 6.0, 600), 5.99 - 0.01 * np.arange(30),
                              5.71 + 0.01 * np.arange(60)])  # fmt: skip
    t = np.arange(x.size) / 1000.0
    motion = time_motion(t, x, velocity=np.gradient(x, t), acceleration=0.0 * x, current=0.0)
    leak = np.asarray(SeatingLeakage(k_s, gap, 1.0).leakage(motion))
    assert leak[400:600] == pytest.approx(0.0, abs=1e-9 * k_s)
    assert leak[600] == pytest.approx(k_s, rel=0.01)
    on = slice(630, 690)
    left = 0.3 - (x[on] - x[629]) / gap
    assert leak[on] == pytest.approx(k_s * np.maximum(left, 0.0), abs=0.006 * k_s)


def test_an_abrupt_seat_keeps_the_leak_open_to_the_end():
    """F = v/k_s at 90 % of the gap, where one that closes in proportion leaks a tenth."""
    k_s, gap = 5e-5, 1e-3
    late = (0.8 * gap < TRAVEL) & (0.9 * gap > TRAVEL)
    assert late.sum() >= 4
    abrupt, gradual = (np.abs(leaking(0.2, 1.0, k_s, gap, n)[late]) for n in (200.0, 1.0))
    np.testing.assert_allclose(abrupt, 0.2 * np.abs(V[late]) / k_s, rtol=0.01)
    assert (gradual > 4.0 * abrupt).all()


def test_no_leak_is_the_valve_itself():
    assert np.array_equal(leaking(1.0, 1.0, 0.0, 4e-4), stiff_valve(
        sine_motion(A, 1.0, 1.0, points=POINTS)).total[0])  # fmt: skip


def test_noise_does_not_count_as_reversals():
    """A ramp with steps back of 0.1 mm in a play of 0.5 mm: each costs no more than itself."""
    n = np.arange(300)
    x = 5e-5 * n - 1e-4 * (n % 10 == 9)
    motion = time_motion(n / 300.0, x, velocity=np.full(300, 0.015), acceleration=0.0 * x,
                         current=0.0)  # fmt: skip
    steps = travelled(motion, jnp.asarray(5e-4))
    forward = np.asarray(steps.moved)[20:] > 0.0
    used = np.asarray(steps.before)[20:][forward]
    assert used.min() == pytest.approx(5e-4 - 5e-5)
    assert (used == 5e-4).mean() > 0.6


def test_the_leak_is_found_across_a_kink():
    """A yield force that sets in as the square root of speed: Newton's method alone hops across."""

    def creeping(motion: Motion) -> Parts:
        s = motion.velocity / 1e-5
        force = 1000.0 * s / (1.0 + jnp.sqrt(jnp.sqrt(s * s + 1e-12))) ** 2
        return Parts(yielding=force, viscous=3000.0 * motion.velocity)

    motion = sine_motion(0.005, 1.0, 0.0, points=360)
    k = jnp.asarray(np.geomspace(1e-9, 1e-4, 40)[:, None])
    wide = eqx.tree_at(
        lambda m: m.velocity, motion, jnp.broadcast_to(motion.velocity, (40, 360)) + 1e-5
    )
    found = parts_beside_leak(wide, creeping, k)
    w = wide.velocity - k * found.total
    again = creeping(eqx.tree_at(lambda m: m.velocity, motion, w)).total
    np.testing.assert_allclose(found.total, again, atol=1e-3)
