"""Where effects of temperature are not looked for, and what is said of them then."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.selection import between_tests
from sysid.diagnosis.warmth import drifts_like_warmth, warmth_unseen
from sysid.diagnosis.within_tests import Within
from sysid.effects.registry import EFFECTS, effect_kind, make
from sysid.motion.history import run_history

THERMAL = {e.facts.id for e in EFFECTS if e.facts.of_temperature}


@pytest.mark.parametrize(
    ("temperature", "why"),
    [
        ([25.0, 25.0, 25.0], "all tests are at one temperature (25 °C)"),
        ([23.2, 25.1, 26.4], "temperatures differ by less than 5 K (23 to 26 °C)"),
        ([20.0, np.nan, 60.0], "the temperature of 1 of 3 tests is not known"),
        ([np.nan] * 3, "no temperature was recorded"),
        ([20.0, 25.0, 60.0], None),
    ],
)
def test_what_temperatures_can_show(temperature, why):
    assert warmth_unseen(np.array(temperature)) == why


def test_these_effects_are_meant():
    assert {
        "viscosity_temperature", "yield_temperature", "stiffness_temperature", "gas_temperature",
    } == THERMAL  # fmt: skip


@pytest.mark.parametrize("id", sorted(THERMAL))
def test_at_one_temperature_no_effect_of_it_is_looked_for(evidence, id):
    """At 25 °C a preload of the gas is −15 K times its force per kelvin: one of two names."""
    one = make(effect_kind(id))
    assert between_tests(one, evidence, thermal=False)
    loops = replace(evidence.loops, temperature=np.full(len(evidence.loops.ids), 25.0))
    same = replace(evidence, loops=loops)
    assert not between_tests(one, same, thermal=False)
    told = {z.id: z.because for z in hidden(same, (), Within())}
    assert told[id] == "all tests are at one temperature (25 °C)"


def test_what_was_not_sought_is_no_question_for_a_further_test(evidence):
    """A fitted model with such an effect beside it contradicts the tests that there are."""
    loops = replace(evidence.loops, temperature=np.full(evidence.tests, 25.0))
    absorbed = {z.id for z in hidden(replace(evidence, loops=loops), (), Within()) if z.absorbed}
    assert not absorbed
    dim = Scored(make(effect_kind("linear_viscosity")), 0.0, 9.0, 0.0, 0.0, 1.0, evidence.measured)
    assert {z.id for z in hidden(evidence, (dim,), Within()) if z.absorbed} == {"linear_viscosity"}


def test_a_temperature_that_one_test_lacks_is_asked_for(evidence):
    temperature = evidence.loops.temperature.copy()
    temperature[3] = np.nan
    loops = replace(evidence.loops, temperature=temperature)
    told = {z.id: z.test for z in hidden(replace(evidence, loops=loops), (), Within())}
    assert evidence.loops.ids[3] in told["viscosity_temperature"]
    assert "--exclude" in told["viscosity_temperature"]


@pytest.mark.parametrize(
    ("temperature", "either"),
    [
        (np.linspace(22.0, 26.0, 12), True),
        (np.where(np.arange(12) % 2, 22.0, 26.0), False),
        (np.full(12, 25.0), False),
        (np.full(12, np.nan), True),
        (np.linspace(20.0, 60.0, 12), False),
    ],
    ids=["warms up", "now warm, now cold", "the same", "not known", "its own effects are sought"],
)
def test_drift_may_be_warming_where_nothing_says_otherwise(evidence, temperature, either):
    loops = replace(evidence.loops.select(np.arange(12)), temperature=temperature)
    history = run_history(np.arange(12), loops.current)
    assert drifts_like_warmth(loops, history) == either
    assert not drifts_like_warmth(loops, None)


def test_far_off_the_order_is_not_said_to_be_unknown(evidence):
    history = run_history(np.arange(evidence.tests), evidence.loops.current)
    told = {z.id: z.because for z in hidden(replace(evidence, history=history), (), Within())}
    assert "too far off" in told["run_drift"]
    told = {z.id: z.because for z in hidden(replace(evidence, history=None), (), Within())}
    assert "order of the tests is not known" in told["run_drift"]
