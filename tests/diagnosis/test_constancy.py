"""A size that is the same in all tests, and one that is not."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.constancy import REFUTED, VariedSize, curve, varied_size
from sysid.diagnosis.contenders import LEAST_GAIN
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.judged import in_doubt
from sysid.diagnosis.remaining_words import refuted_told
from sysid.diagnosis.state import settle
from sysid.effects.registry import effect_kind, make
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from tests.diagnosis.diagnosed import DESIGN

STIFF = VariedSize("gas_spring", 100.0, 0.8, "amplitude", 2.5e-3, 75e-3, 3900.0, 390.0)


@pytest.fixture(scope="module")
def stuck(base_state):
    """A floating piston that sticks, taken for a gas spring: evidence, state and its gain."""
    trial = make_trial(71, (find_planter("sticking_piston"),), (2.0,), DESIGN)
    found = gather(trial.loops)
    base = settle(found, base_state.coordinates, base_state.u)
    spring = make(effect_kind("gas_spring"))
    extended = DamperCoordinates(base.coordinates.valve_coordinates, (spring,))
    state = settle(found, extended, np.append(base.u, 0.3), base.covariance)
    return found, state, state.likelihood - base.likelihood


def test_the_stiffness_of_a_gas_spring_is_one_number(evidence, base_state, spring_state):
    found = varied_size(evidence, spring_state, 0)
    gain = spring_state.likelihood - base_state.likelihood
    assert gain > 100.0
    assert found.gained < 0.05 * gain
    assert found.spread < 0.1
    assert not found.refutes(gain)


def test_a_spring_that_softens_with_the_stroke_is_no_gas_spring(stuck):
    found, state, gain = stuck
    assert gain > LEAST_GAIN  # it would be added
    varied = varied_size(found, state, 0)
    assert varied.refutes(gain)
    assert varied.quantity == "amplitude"
    assert varied.least == pytest.approx(found.loops.amplitude.min())
    assert varied.at_least > 3.0 * varied.at_most > 0.0, "stuck, it is the oil that yields"


def test_a_formula_is_refuted_by_evidence_and_by_size():
    """By either alone it is not: formulas are never quite the damper's own, and noise varies."""
    assert STIFF.refutes(100.0)
    assert not STIFF.refutes(1.1 * STIFF.gained / REFUTED)
    assert not replace(STIFF, spread=0.9 * REFUTED).refutes(100.0)
    assert not replace(STIFF, gained=0.9 * LEAST_GAIN).refutes(1.0)


def test_what_is_weaker_than_what_a_refuted_effect_leaves_may_be_part_of_it():
    kept = ("gas_spring", "stribeck_friction", "backlash")
    assert in_doubt((STIFF,), kept, (120.0, 99.0, 101.0)) == {"gas_spring", "stribeck_friction"}
    assert in_doubt((), kept, (120.0, 20.0, 13.0)) == set()


def test_curves_are_uncorrelated_over_the_tests_that_count():
    quantity, weight = np.log([1.0, 2.0, 2.0, 5.0, 10.0]), np.array([0.1, 3.0, 1.0, 2.0, 7.0])
    found = curve(quantity, weight)
    table = np.column_stack([np.ones(5), found])
    gram = table.T @ (table * weight[:, None]) / weight.sum()
    np.testing.assert_allclose(gram, np.eye(3), atol=1e-12)
    two = curve(np.array([0.0, 1.0, 1.0, 0.0, 1.0]), weight)
    assert two.shape == (5, 1), "two levels bear a straight line"
    assert curve(np.full(5, 3.0), weight).shape == (5, 0)


def test_it_is_told_how_the_size_would_have_to_go():
    told = refuted_told(STIFF)
    assert "a gas spring" in told
    assert "from 3.9 kN/m at 2.5 mm to 0.39 kN/m at 75 mm" in told
    at_no_one = VariedSize("gas_spring", 100.0, 0.8)
    assert "not at one size" in refuted_told(at_no_one)
