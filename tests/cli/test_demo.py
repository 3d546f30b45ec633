"""`sysid demo`: what is hidden is found, and the seal says so."""

import json

import pytest

from sysid.cli.app import run
from sysid.cli.demo import HIDDEN, PERCENT, design
from sysid.data.campaign import load_campaign
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from sysid.trials.raw_tests import raw_tests
from tests.trials.campaigns import SMALL


@pytest.mark.slow
def test_the_story_ends_well(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sysid.cli.demo.design", lambda: SMALL)  # programs compiled for others
    assert run(["demo", "-o", str(tmp_path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["hidden"]["planter"] == "rod_play"
    (cause,) = told["diagnosis"]["causes"]
    assert cause["id"] == "backlash"
    delta = cause["parameters"]["delta"]["value"]
    assert delta == pytest.approx(told["hidden"]["quantities"]["size"], rel=0.03)
    assert (tmp_path / "diagnosis" / "report.html").stat().st_size > 1e5
    assert run(["demo", "-o", str(tmp_path)]) == 1
    assert "overwrites no tests" in capsys.readouterr().err


@pytest.mark.parametrize("seed", range(len(HIDDEN)))
def test_everything_can_be_hidden_and_is_read_back(seed, tmp_path):
    trial = make_trial(3 + seed, (find_planter(HIDDEN[seed]),), (PERCENT,), design())
    assert trial.truth.sizes == pytest.approx((PERCENT,), abs=0.1)
    for name, content in raw_tests(trial, "hidden", seed).items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
    loaded = load_campaign(tmp_path, None, flip_force=False)
    assert len(loaded.records) == 24
    assert not loaded.notes
    first = loaded.records[0]
    where = trial.loops.ids.index(first.id)
    assert first.displacement.size == 4 * 120
    assert first.force.mean() == pytest.approx(trial.loops.force[where].mean(), abs=0.1)
