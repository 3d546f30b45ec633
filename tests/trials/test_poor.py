"""Campaigns that are poor by design, and the tests that settle them."""

import numpy as np
import pytest

from sysid.diagnosis.diagnose import diagnose_loops
from sysid.diagnosis.questions import Alternative
from sysid.models.damper import Damper
from sysid.models.generalized import Generalized
from sysid.parameters import build
from sysid.planning.candidates import Candidate, motion_of
from sysid.planning.discrimination import predict_on
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.trials import poor
from sysid.trials.poor import LIMITS, POVERTIES, poor_settings, run_poor


@pytest.mark.parametrize("poverty", POVERTIES)
def test_settings_lack_what_they_are_said_to(poverty):
    for seed in range(5):
        settings = poor_settings(poverty, seed)
        levels = {
            "one_frequency": {s.frequency for s in settings},
            "one_current": {s.current for s in settings},
            "two_excitations": {(s.amplitude, s.frequency) for s in settings},
        }
        assert len(levels[poverty]) == (2 if poverty == "two_excitations" else 1)
        assert len(settings) >= 10
        assert max(2.0 * np.pi * s.amplitude * s.frequency for s in settings) <= LIMITS.velocity
    assert len({poor_settings(poverty, seed) for seed in range(20)}) > 3


def diagnosed(trial: Trial):
    return diagnose_loops(trial.loops, models=(("generalized", "symmetric"),), seed=1)


def test_a_gas_spring_at_one_frequency_is_settled_by_the_test_that_is_recommended():
    """Spring, or mass that a load cell compensates too much: plain with a second frequency only."""
    row = run_poor("one_frequency", 78_002, find_planter("large_gas_chamber"), diagnosed)
    assert row.failure is None
    assert row.before == "right_class"
    assert {"gas_spring", "fixture_inertia"} <= set(row.members)
    assert "fluid_inertia" not in row.members, "oil has no negative mass"
    assert row.tests
    assert row.after is not None
    assert row.after.right
    assert row.after.left == ("gas_spring",)


def test_what_nobody_can_see_is_not_diagnosed():
    row = run_poor("one_frequency", 11, find_planter("late_sampling"), _never)
    settings = poor_settings("one_frequency", 11)
    assert settings[0].frequency == 0.1
    assert not row.detectable
    assert row.before == ""
    assert row.loops == len(settings)


def test_a_triangle_is_held_against_predictions_on_the_motion_that_the_rig_made():
    """Whose corners are its own: on those that were planned the true model would be refuted."""
    trial = make_trial(78_004, (), settings=poor_settings("one_current", 78_004))
    valve = build(Generalized, trial.truth.parameters)
    one = Alternative((), Damper(valve), (), (), np.zeros((0, 0)))
    test = Candidate("triangle", 5e-3, 15.0, 0.0)
    motion, measured = poor._run(trial, poor._setting(test))
    ran, planned = (
        predict_on(one, m).harmonics - measured for m in (motion, motion_of([test], 40.0))
    )
    size = np.linalg.norm(measured)
    assert np.linalg.norm(ran) < 0.03 * size  # gain, zero and delay of the rig
    assert np.linalg.norm(planned) > 0.1 * size


def _never(trial: Trial):
    raise AssertionError("was diagnosed")
