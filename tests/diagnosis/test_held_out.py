"""Held-out errors are those of a fit without the condition, and the gain has an honest interval."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis import coarse
from sysid.diagnosis.acting import without
from sysid.diagnosis.evidence import Evidence, gather
from sysid.diagnosis.held_out import (
    errors_in_blocks,
    errors_without,
    extrapolate,
    gain_of,
    leave_conditions_out,
)
from sysid.diagnosis.held_out_words import what_was_held_out
from sysid.diagnosis.plain import plainly_fitted, unweighted
from sysid.diagnosis.state import settle
from sysid.effects.force.bump_stop import BumpStop
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion


@pytest.fixture(scope="module")
def held_out(evidence, base_state):
    return leave_conditions_out(evidence, base_state)


def test_every_condition_is_predicted_by_a_fit_without_it(evidence, base_state, held_out):
    """A few steps from the fit to all tests end where a fit from the start ends."""
    for number in np.unique(evidence.condition)[::5]:
        out = evidence.condition == number
        fewer = gather(evidence.loops.select(~out))
        state = settle(fewer, base_state.coordinates, base_state.u, passes=3)
        damper = valve_at(state.coordinates, jnp.asarray(state.u))
        force = np.asarray(simulate(damper, loop_motion(evidence.loops)))
        rmse = np.sqrt(np.mean((force - evidence.loops.force) ** 2, axis=1))
        np.testing.assert_allclose(held_out[out], (rmse / evidence.peak)[out], rtol=0.05)


@pytest.fixture(scope="module")
def stop_in_one_condition(evidence, base_state):
    """A stop that only the tests of the farthest stroke at one frequency reach, and its model."""
    loops = evidence.loops
    widest = loops.amplitude > 0.9 * loops.amplitude.max()
    number = evidence.condition[int(np.argmax(widest))]
    there = evidence.condition == number
    loops = loops.select(~widest | there)
    begin = 0.8 * float(loops.amplitude.max())
    into = np.maximum(np.abs(loops.displacement) - begin, 0.0) * np.sign(loops.displacement)
    loops = replace(loops, force=loops.force + 1e5 * into)
    stop = BumpStop(k_b=1e5, x_b=begin)
    coordinates = DamperCoordinates(base_state.coordinates.valve_coordinates, (stop,))
    valve = valve_at(base_state.coordinates, jnp.asarray(base_state.u)).valve
    u = np.asarray(place_of(coordinates, Damper(valve, (stop,))))
    own = unweighted(gather(loops))
    return own, base_state, plainly_fitted(own, coordinates, u)


def test_what_acts_in_no_other_test_is_not_known_from_others(stop_in_one_condition):
    """Of tests that alone reach a stop a model with it knows no more than one without."""
    evidence, base, state = stop_in_one_condition
    reach = evidence.loops.amplitude > 0.9 * evidence.loops.amplitude.max()
    assert np.unique(evidence.condition[reach]).size == 1
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    in_sample = evidence.errors(damper)[reach]
    plain = plainly_fitted(evidence, base.coordinates, base.u)
    bare, with_stop = (leave_conditions_out(evidence, z) for z in (plain, state))
    assert in_sample.mean() < 0.3 * bare[reach].mean()
    np.testing.assert_allclose(with_stop[reach], bare[reach], rtol=0.02)
    np.testing.assert_allclose(without(damper, (0,)).effects[0].k_b, 0.0)


def test_it_is_told_that_such_an_effect_has_no_gain_there(stop_in_one_condition):
    evidence, base, state = stop_in_one_condition
    widest = evidence.loops.amplitude > 0.9 * evidence.loops.amplitude.max()
    where = f"{1e3 * float(np.median(evidence.loops.amplitude[widest])):.3g} mm"
    told = what_was_held_out(evidence, state)
    assert len(told) == 1
    assert f"acts in the tests of {where}" in told[0]
    assert what_was_held_out(evidence, base) == ()
    parted = replace(evidence, condition=np.arange(evidence.tests))
    assert "left out in parts, by temperature" in what_was_held_out(parted, base)[0]


def test_a_block_is_predicted_from_the_others_as_if_its_conditions_were_one(evidence, base_state):
    found = errors_in_blocks(evidence, base_state, 3)
    for k in range(3):
        out = evidence.ordered_condition % 3 == k
        assert np.unique(evidence.condition[out]).size > 1
        np.testing.assert_array_equal(
            found[:, out], errors_without(evidence, base_state, out)[:, out]
        )


def test_more_blocks_than_conditions_are_one_for_each(evidence, base_state, held_out):
    found = errors_in_blocks(evidence, base_state, 1000)[0]
    np.testing.assert_array_equal(found, held_out)


def test_far_from_any_model_conditions_are_held_out_in_few_blocks(
    evidence, base_state, monkeypatch
):
    monkeypatch.setattr(coarse, "BLOCKS", 3)
    expected = errors_in_blocks(evidence, base_state, 3, coarse.ROUGH)[0].mean()
    assert expected != pytest.approx(leave_conditions_out(evidence, base_state).mean())
    assert coarse._unseen(evidence, base_state) == pytest.approx(expected)


def test_a_single_block_leaves_nothing_to_predict_from(evidence, base_state):
    damper = valve_at(base_state.coordinates, jnp.asarray(base_state.u))
    np.testing.assert_array_equal(
        errors_in_blocks(evidence, base_state, 1), evidence.errors_and_shapes(damper)
    )


def test_unseen_tests_are_predicted_worse_than_seen_ones(evidence, base_state, held_out):
    seen = evidence.errors(valve_at(base_state.coordinates, jnp.asarray(base_state.u)))
    assert held_out.mean() > seen.mean()
    worst = np.argmax(held_out - seen)
    alone, _ = errors_without(evidence, base_state, evidence.condition == evidence.condition[worst])
    assert alone[worst] == pytest.approx(held_out[worst])


def test_the_gain_of_a_spring_is_held_out(evidence, spring_state, held_out):
    after = leave_conditions_out(evidence, spring_state)
    gain = gain_of(evidence, held_out, after)
    assert gain.before == pytest.approx(held_out.mean())
    assert gain.after == pytest.approx(after.mean())
    assert gain.after < 0.7 * gain.before
    assert gain.low < gain.reducible_explained < gain.high
    expected = (gain.before - gain.after) / (gain.before - gain.floor)
    assert gain.reducible_explained == pytest.approx(expected)
    assert gain.floor == pytest.approx(gain.repeatability / np.sqrt(8), rel=1e-6), "of 8 cycles"


def test_the_interval_is_over_conditions(evidence):
    """The same mean gain, once shared by all conditions and once owed to one of them alone."""
    before = np.full(evidence.tests, 0.03)
    even = gain_of(evidence, before, before - 0.01)
    one = evidence.condition == evidence.condition[0]
    lone = gain_of(evidence, before, before - 0.01 * one / one.mean())
    assert lone.reducible_explained == pytest.approx(even.reducible_explained)
    assert lone.high - lone.low > 5.0 * (even.high - even.low)
    assert lone.low < 0.05, "without that condition there is no gain"


def grouped(evidence, count):
    """The same tests as if they were of so many conditions."""
    return replace(evidence, condition=np.arange(evidence.tests) % count)


@pytest.mark.parametrize("count", [3, 4, 8, 20])
def test_the_interval_holds_the_truth_for_few_conditions_as_well(evidence, count):
    """Errors vary by condition, a third of them is explained; 95 in 100, and not 100 either."""
    some = grouped(evidence, count)
    rng = np.random.default_rng(count)
    held = []
    for _ in range(400):
        before = 0.03 * np.exp(0.5 * rng.standard_normal(count))[some.condition]
        left = 1.0 - 0.4 * rng.uniform(0.0, 2.0, count)[some.condition]
        known = np.full(some.tests, np.nan)
        gain = gain_of(
            replace(some, loops=replace(some.loops, noise_floor=known)), before, before * left
        )
        held.append(gain.low < 0.4 < gain.high)
    assert 0.90 < np.mean(held) < 0.985


def test_few_conditions_have_no_interval(evidence):
    before = np.full(evidence.tests, 0.03)
    gain = gain_of(grouped(evidence, 2), before, before / 2)
    assert np.isnan([gain.low, gain.high]).all()
    assert gain.reducible_explained > 0.5


def test_one_single_cycle_does_not_lower_the_floor(evidence):
    before = np.full(evidence.tests, 0.03)
    floor = evidence.loops.noise_floor.copy()
    whole = gain_of(evidence, before, before / 2).floor
    floor[::2] = np.nan
    some = replace(evidence, loops=replace(evidence.loops, noise_floor=floor))
    assert gain_of(some, before, before / 2).floor == pytest.approx(whole, rel=0.3)


def test_below_the_floor_nothing_can_be_explained(evidence):
    before = np.full(evidence.tests, 1e-5)
    gain = gain_of(evidence, before, before / 2)
    assert gain.floor > gain.before
    assert np.isnan(gain.reducible_explained)


def test_no_gain_is_no_gain(evidence):
    rng = np.random.default_rng(1)
    before = 0.02 + 0.002 * rng.standard_normal(evidence.tests)
    after = 0.02 + 0.002 * rng.standard_normal(evidence.tests)
    gain = gain_of(evidence, before, after)
    assert gain.low < 0.0 < gain.high


def test_single_cycles_have_no_known_repeatability(evidence):
    unknown = replace(evidence.loops, noise_floor=np.full(evidence.tests, np.nan))
    before = np.full(evidence.tests, 0.03)
    gain = gain_of(replace(evidence, loops=unknown), before, before / 2)
    assert np.isnan(gain.floor)
    assert np.isnan(gain.repeatability)
    assert gain.reducible_explained == pytest.approx(0.5)


def test_each_model_is_held_against_its_own_tests(evidence, base_state):
    """What is taken out of the cycles for the second is in the tests of the first."""
    changed = replace(evidence, measured=1.3 * evidence.measured, force=1.3 * evidence.force)
    told = extrapolate((evidence, base_state), (changed, base_state))
    alone = extrapolate((evidence, base_state), (evidence, base_state))
    assert [b for _, b, _ in told] == [b for _, b, _ in alone]
    assert all(a != b for _, b, a in told)


def test_extremes_are_left_out_for_extrapolation(evidence, base_state, spring_state):
    both = ((evidence, base_state), (evidence, spring_state))
    splits = {words: (b, a) for words, b, a in extrapolate(*both)}
    assert set(splits) == {
        "the largest amplitudes", "the highest frequencies", "the largest currents",
        "the highest temperatures",
    }  # fmt: skip
    before, after = splits["the largest amplitudes"]
    assert after < 0.5 * before


@pytest.mark.parametrize("left", [0.0, 1e-3])
def test_what_a_table_has_at_the_largest_current_is_not_extrapolated_to(
    evidence, base_state, spring_state, monkeypatch, left
):
    """Without tests at that current it could be anything: the fit would leave it where it was.

    Nor where a smooth law lets a thousandth of it act at the other currents.
    """
    look = Evidence.look
    current = np.abs(evidence.loops.current)
    others = current < current.max() - 0.1 * np.ptp(current)

    def tabulated(self, coordinates, u):
        residual, jacobian = look(self, coordinates, u)
        jacobian = np.array(jacobian)
        jacobian[others, :, 0] *= left
        return residual, jacobian

    monkeypatch.setattr(Evidence, "look", tabulated)
    splits = extrapolate((evidence, base_state), (evidence, spring_state))
    told = {words for words, _, _ in splits}
    assert "the largest currents" not in told
    assert "the largest amplitudes" in told
