"""What a law of frequency means to who fits each frequency by itself."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis.at_frequencies import frequencies_told
from sysid.diagnosis.result import Cause
from sysid.effects.registry import effect_kind, make
from tests.data.loop_of import loops_of
from tests.report.made_diagnosis import backlash, quantity


def law(size: float = 0.05, part: str = "whole") -> Cause:
    effect = make(effect_kind("frequency_law"), size, choice={"part": part})
    found = quantity(effect, "eps_f", size, 0.01)
    return replace(
        backlash().causes[0], members=("frequency_law",), effect=effect, parameters=(found,)
    )


def at(*frequencies: float) -> Loops:
    f = np.array(frequencies)
    return loops_of(np.zeros((f.size, 72)), np.full(f.size, 5e-3), f, 0.0 * f)


@pytest.mark.parametrize(
    ("cause", "told"),
    [
        (law(), "the yield force and the viscosity that fit 8 Hz are 1.5 ± 0.3 % above what fits"),
        (law(part="viscous"), "the viscosity that fits 8 Hz is 1.5 ± 0.3 % above what fits 4 Hz"),
        (law(-0.05), "are 1.6 ± 0.3 % below what fits 4 Hz: found at the one, they are wrong"),
    ],
)
def test_parameters_of_one_frequency_are_wrong_at_the_other(cause, told):
    (sentence,) = frequencies_told(cause, at(8.0, 4.0, 4.0))
    assert told in sentence


@pytest.mark.parametrize("status", ["class", "family"])
def test_a_law_that_is_only_one_of_several_is_no_fact(status):
    members = ("frequency_law", "shear_thinning")
    (named,) = frequencies_told(law(), at(4.0, 8.0))
    (sentence,) = frequencies_told(replace(law(), status=status, members=members), at(4.0, 8.0))
    assert named.startswith("So the yield force and the viscosity that fit 8 Hz are ")
    assert sentence.startswith(
        "If it is a force law that depends on frequency, the yield force and the viscosity that "
        "fit 8 Hz are 1.5 "
    )


def test_nothing_is_said_of_one_frequency_or_of_another_cause():
    assert not list(frequencies_told(law(), at(4.0, 4.01)))
    assert not list(frequencies_told(backlash().causes[0], at(4.0, 8.0)))
