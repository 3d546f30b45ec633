"""Where effects of temperature are not looked for, and what is said of them then."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.selection import between_tests
from sysid.diagnosis.warmth import warmth_unseen
from sysid.diagnosis.within_tests import Within
from sysid.effects.registry import EFFECTS, effect_kind, make

THERMAL = {e.facts.id for e in EFFECTS if e.facts.of_temperature}


@pytest.mark.parametrize(
    ("temperature", "why"),
    [
        ([25.0, 25.0, 25.0], "all tests are at one temperature (25 °C)"),
        ([23.2, 25.1, 26.4], "all tests are at one temperature (23 to 26 °C)"),
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


def test_far_off_the_order_is_not_said_to_be_unknown(evidence):
    told = {z.id: z.because for z in hidden(replace(evidence, history=True), (), Within())}
    assert "too far off" in told["run_drift"]
    told = {z.id: z.because for z in hidden(replace(evidence, history=False), (), Within())}
    assert "order of the tests is not known" in told["run_drift"]
