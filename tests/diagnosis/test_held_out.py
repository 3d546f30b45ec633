"""Held-out errors are those of a fit without the condition, and the gain has an honest interval."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.evidence import gather
from sysid.diagnosis.held_out import errors_without, extrapolate, gain_of, leave_conditions_out
from sysid.diagnosis.state import settle
from sysid.models.coordinates import valve_at
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
    assert gain.floor == 0.0
    assert np.isnan(gain.repeatability)
    assert gain.reducible_explained == pytest.approx(0.5)


def test_extremes_are_left_out_for_extrapolation(evidence, base_state, spring_state):
    splits = {words: (b, a) for words, b, a in extrapolate(evidence, base_state, spring_state)}
    assert set(splits) == {
        "the largest amplitudes", "the highest frequencies", "the largest currents",
        "the highest temperatures",
    }  # fmt: skip
    before, after = splits["the largest amplitudes"]
    assert after < 0.5 * before
