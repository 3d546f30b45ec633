"""The fast slice of the study: hidden effects, and the real diagnosis."""

from typing import Any

import numpy as np
import pytest

from sysid.cards.open_questions import FILE, open_file, open_text, read_open
from sysid.data.loops import Loops
from sysid.data.manifest import Manifest
from sysid.diagnosis.result import Diagnosis
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.planning.advice import advise
from sysid.trials.one import diagnose_or_fail
from sysid.trials.outcome import run_trial
from tests.trials.campaigns import small_spec


@pytest.mark.slow
@pytest.mark.parametrize("seed", [81, 82])
def test_silent_without_an_effect(seed):
    row = run_trial(small_spec("none", seed), diagnose_or_fail)
    assert row.failure is None
    assert not row.score.judged


@pytest.mark.slow
def test_silent_under_misfit():
    row = run_trial(small_spec("none_misfit", 83, misfit=2.0), diagnose_or_fail)
    assert row.failure is None
    assert not row.score.judged


@pytest.mark.slow
@pytest.mark.parametrize("planter", ["gas_preload", "bent_load_cell", "side_load", "soft_mount"])
def test_a_hidden_effect_is_found(planter):
    row = run_trial(small_spec("one", 84, planter), diagnose_or_fail)
    assert row.visible
    assert row.score.all_found, row.score
    assert row.score.spurious == 0
    assert row.sizes == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
def test_an_effect_far_below_the_rigs_errors_is_found():
    """It lowers no error that could be seen, .9 % a test, and its likelihood is plain."""
    row = run_trial(small_spec("one", 89, "orifice", percent=0.08), diagnose_or_fail)
    assert row.score.all_found, row.score
    assert row.score.spurious == 0
    assert abs(row.gain) < 0.05


@pytest.mark.slow
def test_what_the_cycles_show_is_no_seal_friction():
    """Particles that settled: a friction of the first cycles, of which the mean holds a part."""
    row = run_trial(small_spec("history", 88, "settled_particles", percent=2.0), diagnose_or_fail)
    assert row.score.found == ("right_name",)
    assert row.score.spurious == 0
    assert row.sizes == pytest.approx(1.0, abs=0.1)
    assert row.gain > 0.8 * row.oracle_gain


@pytest.mark.slow
def test_a_class_has_the_test_that_splits_it(tmp_path):
    """Oil and fixture inertia are the same in every loop, and not in the rig without the damper."""
    found: list[Diagnosis] = []

    def kept(loops: Loops, **options: Any) -> Diagnosis:
        found.append(diagnose_or_fail(loops, **options))
        return found[-1]

    row = run_trial(small_spec("one", 85, "oil_column"), kept)
    assert row.score.found == ("right_class",)
    (diagnosis,) = found
    (question,) = (q for q in diagnosis.open.questions if q.kind == "class")
    assert {one.ids for one in question.alternatives} == {("fluid_inertia",), ("fixture_inertia",)}
    motion = loop_motion(diagnosis.loops)
    one, other = (np.asarray(simulate(a.damper, motion)) for a in question.alternatives)
    assert np.abs(one - other).max() < 1e-3 * np.abs(one).max()
    text = open_text(open_file(diagnosis.open, diagnosis, Manifest()))
    (tmp_path / FILE).write_text(text)
    case = read_open(tmp_path)
    plan = advise(case.asked, case.limits, case.temperature)
    assert [a.test.kind for a in plan.tests if a.about == question.about] == ["rod_disconnected"]


@pytest.mark.slow
def test_outside_the_catalogue_nothing_foreign_is_named():
    row = run_trial(small_spec("outside", 86, "check_valve", percent=2.0), diagnose_or_fail)
    assert row.failure is None
    assert not row.score.outside_family


@pytest.mark.slow
def test_another_damper_is_no_hidden_effect():
    row = run_trial(small_spec("bouc_wen", 87, model="bouc_wen"), diagnose_or_fail)
    assert row.answer == "base_inadequate" or not row.base.startswith("generalized")
