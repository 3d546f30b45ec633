"""The fast slice of the study: hidden effects, and the real diagnosis."""

from importlib.util import find_spec

import pytest

from sysid.trials.outcome import run_trial
from tests.trials.campaigns import small_spec

pytestmark = pytest.mark.skipif(
    find_spec("sysid.diagnosis.diagnose") is None, reason="there is no diagnosis yet"
)


@pytest.fixture(scope="module")
def diagnose():
    from sysid.diagnosis.diagnose import diagnose_loops  # type: ignore[import-not-found]

    return diagnose_loops


@pytest.mark.slow
@pytest.mark.parametrize("seed", [81, 82])
def test_silent_without_an_effect(diagnose, seed):
    row = run_trial(small_spec("none", seed), diagnose)
    assert row.failure is None
    assert not row.score.judged


@pytest.mark.slow
def test_silent_under_misfit(diagnose):
    row = run_trial(small_spec("none_misfit", 83, misfit=2.0), diagnose)
    assert row.failure is None
    assert not row.score.judged


@pytest.mark.slow
@pytest.mark.parametrize("planter", ["gas_preload", "bent_load_cell", "side_load", "soft_mount"])
def test_a_hidden_effect_is_found(diagnose, planter):
    row = run_trial(small_spec("one", 84, planter), diagnose)
    assert row.visible
    assert row.score.all_found, row.score
    assert row.score.spurious == 0


@pytest.mark.slow
def test_a_class_has_the_test_that_splits_it(diagnose):
    """Oil and fixture inertia are the same in every loop."""
    row = run_trial(small_spec("one", 85, "oil_column"), diagnose)
    assert row.score.found == ("right_class",)


@pytest.mark.slow
def test_outside_the_catalogue_nothing_foreign_is_named(diagnose):
    row = run_trial(small_spec("outside", 86, "check_valve", percent=2.0), diagnose)
    assert row.failure is None
    assert not row.score.outside_family


@pytest.mark.slow
def test_another_damper_is_no_hidden_effect(diagnose):
    row = run_trial(small_spec("bouc_wen", 87, model="bouc_wen"), diagnose)
    assert row.answer == "base_inadequate" or not row.base.startswith("generalized")
