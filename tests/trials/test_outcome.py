"""A trial from hiding to scoring, with answers made by hand, and rates over such trials."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sysid.errors import FitError
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from sysid.trials.outcome import read_row, run_trial
from sysid.trials.summary import baseline, confusions, gain_ratio, ours, rates, sizes
from tests.trials.answers import a_cause, diagnosis, named
from tests.trials.campaigns import SMALL, small_spec

SEED = 51
SPEC = small_spec("one", SEED, "gas_preload")


def planted_offset() -> float:
    trial = make_trial(SEED, (find_planter("gas_preload"),), (1.0,), SMALL)
    added = trial.truth.force - trial.truth.force_without
    return float(added.mean())


def knowing(loops, *, history, seed):
    """An answer that is right, 10 % too small, with an interval that covers."""
    offset = planted_offset()
    cause = a_cause(
        "force_offset", value=0.9 * offset, width=0.2 * offset, extra_error=0.9 * offset
    )
    return diagnosis(loops, (cause,), gain=0.001)


def mistaken(loops, *, history, seed):
    return diagnosis(loops, (a_cause("backlash", value=1e-4),))


def silent(loops, *, history, seed):
    return diagnosis(loops, invisible=("load_cell_gain",))


@pytest.fixture(scope="module")
def right():
    return run_trial(SPEC, knowing, lambda base, loops: (named("gas_spring"),))


@pytest.fixture(scope="module")
def wrong():
    return run_trial(SPEC, mistaken)


def test_a_right_answer(right):
    assert right.score.all_found
    assert right.causes == ("force_offset",)
    assert right.percents[0] == pytest.approx(1.0, rel=0.01)
    assert right.visible
    assert right.visibility[0].own == pytest.approx(1.0, abs=1e-6)
    assert right.sizes == pytest.approx(0.9, rel=1e-6)
    (found,) = right.recovered
    assert found.value / found.true == pytest.approx(0.9)
    assert found.low < found.true < found.high
    assert right.gain == pytest.approx(0.1)
    assert right.oracle_gain is not None
    assert right.baseline.found == ("wrong",)


def test_the_oracle_takes_the_planted_force_away(wrong):
    """Before: the diagnosis' own held-out error; after: the base on loops without the effect."""
    assert wrong.before == pytest.approx(2.0)
    assert 0.5 < wrong.oracle_gain < 2.0


def test_a_wrong_answer(wrong):
    assert wrong.score.found == ("wrong",)
    assert wrong.score.spurious == 1
    assert wrong.sizes is None
    assert wrong.recovered == ()


def test_what_the_diagnosis_gets(monkeypatch):
    """Loops, their order and a seed; the truth is in none of them."""
    seen = {}

    def spy(*args, **kwargs):
        seen["args"], seen["kwargs"] = args, kwargs
        return silent(*args, **kwargs)

    run_trial(SPEC, spy)
    (loops,) = seen["args"]
    assert set(seen["kwargs"]) == {"history", "seed"}
    assert "preload" not in repr(loops)
    share = sorted(seen["kwargs"]["history"].share)
    assert share == pytest.approx(np.linspace(0.0, 1.0, len(loops.ids)))


def test_nothing_hidden():
    row = run_trial(small_spec("none", SEED), silent)
    assert row.answer == "nothing"
    assert not row.score.false_alarm
    assert row.visibility == ()
    assert row.oracle_gain is None
    assert run_trial(small_spec("none", SEED), mistaken).score.false_alarm


def test_invisible_effects_are_listed():
    row = run_trial(small_spec("invisible", SEED, "wrong_calibration"), silent)
    assert row.listed_invisible
    assert not row.visible


def test_a_diagnosis_that_gives_up_has_missed():
    def fails(loops, *, history, seed):
        raise FitError("nothing fits")

    row = run_trial(SPEC, fails)
    assert "nothing fits" in row.failure
    assert row.visibility
    assert row.score is not None, "or a program that crashes would miss nothing"
    assert row.score.found == ("missed",)


def test_what_cannot_be_planted_is_kept():
    row = run_trial(small_spec("one", SEED, "butterworth_channel", percent=300.0), silent)
    assert "cannot be prepared" in row.failure


def test_rows_survive_a_file(right):
    again = read_row(json.loads(json.dumps(right.as_dict())))
    assert again == right


def test_rates(right, wrong):
    alarm = replace(run_trial(small_spec("none", SEED), mistaken), regime="none")
    quiet = run_trial(small_spec("none", SEED), silent)
    rows = [right, right, wrong, alarm, quiet]
    table = {(r.regime, r.what): (r.count.hits, r.count.trials) for r in rates(rows, ours)}
    assert table["one", "right name or class (visible)"] == (2, 3)
    assert table["one", "right when a name is given"] == (2, 3)
    assert table["one", "spurious"] == (1, 3)
    assert table["none", "any name given"] == (1, 2)
    assert table["all", "right of the names given at 0.9 or more"] == (2, 4)
    theirs = {(r.regime, r.what): (r.count.hits, r.count.trials) for r in rates(rows, baseline)}
    assert theirs["one", "right name or class (visible)"] == (0, 2)
    assert ("force_offset", "force_offset", 2) in confusions(rows)
    assert ("nothing", "nothing", 1) in confusions(rows)
    found = sizes(rows)
    assert found.bias == pytest.approx(-0.1)
    assert (found.covered.hits, found.covered.trials) == (2, 2)
    ratio = gain_ratio([right, wrong])
    assert ratio[0] == pytest.approx((right.gain + wrong.gain) / (right.oracle_gain
                                                                  + wrong.oracle_gain))  # fmt: skip
    assert ratio[2] == 2


def test_another_base_is_an_answer_to_another_damper():
    row = run_trial(small_spec("bouc_wen", SEED, model="bouc_wen"), silent)
    (rate,) = [r for r in rates([row]) if "inadequate or" in r.what]
    assert rate.count.hits == 0
    for changed in (replace(row, answer="base_inadequate"), replace(row, base="bouc_wen both")):
        (rate,) = [r for r in rates([changed]) if "inadequate or" in r.what]
        assert rate.count.hits == 1
    poor = replace(row, base="dahl both", admissible=False)
    (rate,) = [r for r in rates([poor]) if "inadequate or" in r.what]
    assert rate.count.hits == 0
