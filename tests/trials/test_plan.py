"""Names of trials, plans, and the seal on them."""

import json

import pytest

from sysid.errors import DataError, OutputError
from sysid.trials.plan import COUNTS, Group, Plan, full_plan, read_plan
from sysid.trials.regimes import REGIMES, plan
from sysid.trials.seal import FILE, seal
from sysid.trials.trial_id import FIRST_SEED, TrialId, parse_id, spec_of


@pytest.mark.parametrize("regime", [r.name for r in REGIMES])
def test_a_name_gives_the_trial_of_the_study(regime):
    """Those that were run before there were names keep what they hid."""
    for k, spec in enumerate(plan(regime, 40, FIRST_SEED[regime])):
        assert spec_of(parse_id(f"{regime}:{FIRST_SEED[regime] + k}")) == spec


@pytest.mark.parametrize(
    "name",
    [
        "one:30003",
        "one:30003:percent=0.5",
        "one_misfit:40001:misfit=5:noise=18",
        "two:60007:effect=gas_preload+soft_mount:percent=0.25",
        "physical:100000:level=5",
        "physical:100002:effect=play",
    ],
)
def test_a_name_comes_back(name):
    assert str(parse_id(name)) == name


def test_what_a_name_asks_for_is_hidden():
    spec = spec_of(parse_id("one:30003:effect=soft_mount:percent=0.5:noise=18:misfit=2"))
    assert (spec.planters, spec.percents) == (("soft_mount",), (0.5,))
    assert (spec.design.noise, spec.misfit) == (18.0, 2.0)
    usual = spec_of(parse_id("one:30003"))
    assert (usual.percents, usual.design.noise, usual.misfit) == ((1.0,), 9.0, 0.0)


@pytest.mark.parametrize(
    "line",
    ['regime = "onee"', 'regime = "one"\neffects = ["nope"]', 'regime = "one"\npercent = -1'],
)
def test_a_plan_that_cannot_be_run_is_told_with_its_file(tmp_path, line):
    file = tmp_path / "plan.toml"
    file.write_text(f"[[trials]]\n{line}\n")
    with pytest.raises(DataError, match=r"plan\.toml: (there is no|percent)"):
        read_plan(file)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("two", "is no trial"),
        ("one:many", "is no trial"),
        ("one:30003:size=3", "is no trial"),
        ("three:10000", "no regime 'three'"),
        ("one:10000", "does not belong to one. Its seeds are 30000 to 39999"),
        ("one:30003:effect=ghost", "no planter 'ghost'"),
        ("physical:100000:effect=ghost", "no mechanism 'ghost'"),
        ("physical:100000:percent=1", "percent means nothing"),
        ("one:30000:level=2", "level means nothing"),
        ("one:30000:percent=nan", "out of range"),
        ("one:30000:percent=0", "hidden with a size of 0 %"),
        ("two:60000:effect=gas_preload+rod_play:percent=0", "gas_preload and rod_play would be"),
        ("none:10000:effect=soft_mount", "soft_mount would be hidden with a size of 0 %. Give its"),
        ("bouc_wen:70000:effect=stiff_seal", "stiff_seal would be hidden"),
    ],
)
def test_what_is_no_trial_is_told(name, message):
    with pytest.raises(DataError, match=message):
        parse_id(name)


def test_the_full_study_has_every_regime_in_proportion():
    trials = full_plan().trials()
    assert len(trials) == sum(COUNTS.values())
    assert set(COUNTS) == set(FIRST_SEED)
    half = [t.regime for t in trials[: len(trials) // 2]]
    for regime, count in COUNTS.items():
        assert half.count(regime) == pytest.approx(count / 2, abs=1)


def test_a_plan_file_has_every_combination(tmp_path):
    path = tmp_path / "plan.toml"
    path.write_text(
        '[[trials]]\nregime = "one"\ncount = 3\nfirst = 5\npercent = [0.25, 1]\nnoise = 18\n'
        'effects = ["soft_mount", "gas_preload"]\n[[trials]]\nregime = "none"\ncount = 2\n'
    )
    trials = read_plan(path).trials()
    assert len(trials) == 3 * 2 + 2
    assert TrialId("one", 30005, ("gas_preload",), percent=0.25, noise=18.0) in trials
    assert {t.kind for t in trials} == {
        "one, percent 0.25, noise 18", "one, percent 1, noise 18", "none",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[trials]]\nregime = 'one'\nsize = 2\n", "extra inputs"),
        ("[[trials]]\nregime = 'one'\ncount = 0\n", "count"),
        ("trials = 3\n", "trials"),
        ("[[trials\n", "is no TOML"),
    ],
)
def test_what_is_no_plan_is_told(text, message, tmp_path):
    (tmp_path / "plan.toml").write_text(text)
    with pytest.raises(DataError, match=message):
        read_plan(tmp_path / "plan.toml")


def test_a_trial_stands_in_a_plan_once():
    with pytest.raises(DataError, match="twice"):
        Plan((Group(regime="one", count=3), Group(regime="one", count=1))).trials()


def test_plan_and_thresholds_are_sealed(tmp_path, monkeypatch):
    one, other = full_plan(["none"], 2), full_plan(["none"], 3)
    digest = seal(one, tmp_path)
    assert seal(one, tmp_path) == digest
    with pytest.raises(OutputError, match="another plan"):
        seal(other, tmp_path)
    monkeypatch.setattr("sysid.trials.seal.program", lambda physical: "0123456789ab")
    with pytest.raises(OutputError, match=r"another program .*0123456789ab"):
        seal(one, tmp_path)
    monkeypatch.undo()
    monkeypatch.setitem(__import__("sysid.trials.seal").trials.seal.THRESHOLDS, "sure", 0.8)
    with pytest.raises(OutputError, match="another threshold"):
        seal(one, tmp_path)
    monkeypatch.undo()
    sealed = json.loads((tmp_path / FILE).read_text())
    sealed["thresholds"]["sure"] = 0.5
    (tmp_path / FILE).write_text(json.dumps(sealed))
    with pytest.raises(DataError, match="was changed after it was sealed"):
        seal(one, tmp_path)


def test_no_plan_is_sealed_over_results_that_are_there(tmp_path):
    plan = full_plan(["none"], 2)
    seal(plan, tmp_path)
    (tmp_path / "trials.jsonl").write_text('{"regime": "none", "seed": 10000}\n')
    (tmp_path / FILE).unlink()
    with pytest.raises(OutputError, match="holds trials but no sealed plan"):
        seal(plan, tmp_path)
    assert not (tmp_path / FILE).exists()


def test_a_regime_has_so_many_trials_and_no_more():
    with pytest.raises(DataError, match="none has no 10001 trials"):
        Plan((Group(regime="none", first=1, count=10_000),)).trials()
    with pytest.raises(DataError, match="percent is empty"):
        Plan((Group(regime="one", count=1, percent=()),)).trials()


def test_a_physical_trial_raises_one_mechanism():
    with pytest.raises(DataError, match="raises one mechanism, not play and wear"):
        parse_id("physical:100000:effect=play+wear")
