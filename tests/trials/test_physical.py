"""The tier on the physical damper, with the files of a shipped campaign in place of its own."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sysid.cli.soundness import unfit
from sysid.errors import DataError
from sysid.rig.trial_matrix import settings_below
from sysid.trials.physical import PEAK_VELOCITY, TESTS, campaign_of, changed, run_physical
from sysid.trials.trial_id import FIRST_SEED, parse_id
from tests.trials.answers import a_cause, diagnosis
from tests.trials.campaigns import small_trial

FIRST = FIRST_SEED["physical"]
SHIPPED = Path(__file__).parents[2] / "datasets" / "virtual-w11-low"


@pytest.fixture
def asked(monkeypatch):
    """Campaigns that the rig was asked for; it gives the shipped files."""
    campaigns = []

    def stand_in(campaign, seed=None):
        campaigns.append(campaign)
        files = [*SHIPPED.glob("*.csv"), SHIPPED / "campaign.toml"]
        return {path.name: path.read_bytes() for path in files}

    monkeypatch.setattr("sysid.rig.physical.files.make_physical", stand_in)
    return campaigns


def test_tests_are_a_choice_of_the_matrix_and_levels_are_what_is_asked():
    campaign, other = (campaign_of(FIRST + k, {"play": 3.0}) for k in range(2))
    assert len(campaign.settings) == TESTS < len(settings_below(PEAK_VELOCITY))
    assert len({s.name for s in campaign.settings}) == TESTS
    assert campaign.levels == {"play": 3.0}
    assert campaign.seed != other.seed
    assert campaign.settings != other.settings


def test_the_diagnosis_gets_loops_and_their_order_and_is_judged_afterwards(asked):
    seen = {}

    def diagnose(loops, *, history, seed):
        seen.update(ids=loops.ids, order=history, seed=seed)
        return diagnosis(loops, (a_cause("backlash"), a_cause("bump_stop")), gain=0.004)

    row = run_physical(parse_id(f"physical:{FIRST}:effect=play:level=5"), diagnose, unfit)
    raised, nominal = asked
    assert (raised.levels, nominal.levels) == ({"play": 5.0}, {})
    assert raised.settings == nominal.settings
    assert row.loops == len(seen["ids"]) == len(list(SHIPPED.glob("*A.csv")))
    np.testing.assert_allclose(sorted(seen["order"].share), np.linspace(0.0, 1.0, row.loops))
    assert seen["seed"] == FIRST
    assert (row.planters, row.causes, row.percents) == (("play",), ("backlash",), (0.0,))
    assert row.score.found == ("right_name",)
    assert [j.verdict for j in row.score.judged] == ["right_name", "wrong"]
    assert row.gain == pytest.approx(0.4)


def test_what_a_raised_mechanism_changes_is_compared_test_by_test():
    loops = small_trial(31).loops
    stronger = replace(loops, force=1.02 * loops.force)
    some = np.arange(5, len(loops.ids))
    assert changed(stronger, loops) == pytest.approx(2.0)
    assert changed(stronger.select(some), loops) == pytest.approx(2.0)


def test_no_answer_names_nothing(asked):
    def fails(loops, *, history, seed):
        raise DataError("crashed somewhere")

    row = run_physical(parse_id(f"physical:{FIRST}:effect=none"), fails, unfit)
    assert asked[0].levels == {}
    assert row.failure == "no answer: crashed somewhere"
    assert (row.score.judged, row.score.false_alarm) == ((), False)
