"""`sysid trials` as a user runs it; the diagnosis is replaced, only the command is looked at."""

import json
from pathlib import Path

import pytest

from sysid.jobs.rows import read_rows
from sysid.trials.outcome import Row
from sysid.trials.physical import score_physical
from sysid.trials.score import Given, score
from sysid.trials.trial_id import parse_id, spec_of
from tests.trials.answers import named, truth_of


@pytest.fixture
def quick(monkeypatch):
    """Trials that take no time: the first planter is found, the others are not."""
    asked = []

    def run(spec, diagnose, baseline=None):
        asked.append((spec.regime, spec.seed))
        truth = truth_of(*spec.planters)
        given = (named(truth.causes[0]),) if spec.planters and spec.seed % 2 == 0 else ()
        return Row(spec.regime, spec.seed, 66, spec.planters, truth.causes, truth.sizes, 0.0,
                   answer="named" if given else "unknown", score=score(given, truth),
                   baseline=score((Given("named", ("gas_spring",), "reactive", float("nan"),
                                         False),), truth))  # fmt: skip

    monkeypatch.setattr("sysid.trials.one.run_trial", run)
    return asked


def order(out: Path, *more: object) -> list[object]:
    return ["trials", "--regime", "one", "--regime", "none", "--count", 3, "--workers", 1,
            "-o", out, *more]  # fmt: skip


def test_a_study_leaves_a_page_numbers_rows_and_a_sealed_plan(quick, sysid, tmp_path):
    said = sysid(*order(tmp_path / "out", "--json"))
    assert said.code == 0
    assert said.json["trials"] == 6
    files = {p.name for p in (tmp_path / "out").iterdir()}
    assert files == {"plan.json", "trials.jsonl", "trials.json", "trials.md"}
    plan = json.loads((tmp_path / "out" / "plan.json").read_text())
    assert plan["sha256"] == said.json["plan_sha256"]
    assert plan["thresholds"]["sure"] == 0.9
    rows = read_rows(tmp_path / "out" / "trials.jsonl")
    assert {row["id"] for row in rows} == {f"one:{30000 + k}" for k in range(3)} | {
        f"none:{10000 + k}" for k in range(3)
    }
    assert all(row["program"] == plan["program"] for row in rows)
    rates = {(r["regime"], r["what"]): r["diagnosis"] for r in said.json["rates"]}
    assert rates["none", "any name given"]["hits"] == 0
    assert rates["one", "right when a name is given"]["hits"] == 2


def test_it_goes_on_and_refuses_another_plan(quick, sysid, tmp_path):
    out = tmp_path / "out"
    assert sysid(*order(out)).code == 0
    lines = (out / "trials.jsonl").read_text().splitlines()
    (out / "trials.jsonl").write_text("\n".join(lines[:4]) + "\n")
    quick.clear()
    assert sysid(*order(out)).code == 0
    assert len(quick) == 2
    said = sysid(*order(out, "--seed", 1))
    assert (said.code, "another plan" in said.err) == (1, True)
    assert len(quick) == 2


def test_ctrl_c_keeps_what_is_finished(quick, sysid, tmp_path, monkeypatch):
    from sysid.trials import one

    real = one.run_trial

    def stops(spec, *args):
        if len(quick) == 2:
            raise KeyboardInterrupt
        return real(spec, *args)

    monkeypatch.setattr(one, "run_trial", stops)
    said = sysid(*order(tmp_path / "out"))
    assert said.code == 130
    assert "2 of 6 are finished and kept" in said.err
    assert "the same command goes on" in said.err
    assert len(read_rows(tmp_path / "out" / "trials.jsonl")) == 2


def test_a_trial_that_cannot_be_run_is_listed_and_is_exit_3(quick, sysid, tmp_path, monkeypatch):
    from sysid.trials import one

    real = one.run_trial

    def fails(spec, *args):
        if spec.seed == 30001:
            raise ZeroDivisionError("division by zero")
        return real(spec, *args)

    monkeypatch.setattr(one, "run_trial", fails)
    said = sysid(*order(tmp_path / "out"))
    assert said.code == 3
    assert "one:30001 could not be run" in said.err
    assert "one:30001" in (tmp_path / "out" / "trials.md").read_text()
    assert len(read_rows(tmp_path / "out" / "trials.jsonl")) == 5


def test_one_trial_is_told_with_its_truth(quick, sysid):
    planter = spec_of(parse_id("one:30002")).planters[0]
    said = sysid("trials", "--one", "one:30002")
    assert said.code == 0
    assert f"Hidden: {planter}" in said.out
    assert "right name" in said.out
    told = sysid("trials", "--one", "one:30002", "--json").json
    assert told["planters"] == [planter]
    assert told["baseline"]["judged"][0]["given"]["confidence"] is None, "it states none"
    said = sysid("trials", "--one", "one:3")
    assert (said.code, "Its seeds are 30000" in said.err) == (1, True)


def test_rows_of_an_earlier_study_make_a_page(quick, sysid, tmp_path):
    assert sysid(*order(tmp_path / "out")).code == 0
    rows = read_rows(tmp_path / "out" / "trials.jsonl")
    old = [{k: v for k, v in row.items() if k not in ("id", "program")} for row in rows]
    file = tmp_path / "old.jsonl"
    file.write_text("".join(json.dumps(row | {"commit": "abc1234"}) + "\n" for row in old))
    said = sysid("trials", "--rows", file, "-o", tmp_path / "page", "--json")
    assert said.code == 0
    assert said.json["programs"] == {"abc1234": 6}
    assert said.json["missing"] is None
    assert "are missing" not in (tmp_path / "page" / "trials.md").read_text()
    assert {p.name for p in (tmp_path / "page").iterdir()} == {"trials.json", "trials.md"}


@pytest.mark.parametrize(
    "words", [[], ["plan.toml", "--regime", "one", "-o", "out"], ["--count", "0", "-o", "out"]]
)
def test_wrong_usage(words, sysid, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert sysid("trials", *words).code == 2
    assert not (tmp_path / "out").exists()


def test_without_dask_it_goes_on_in_this_process(quick, sysid, tmp_path, monkeypatch):
    monkeypatch.setattr("sysid.jobs.cluster.is_installed", lambda: False)
    words = [w if w != 1 else 2 for w in order(tmp_path / "out")]
    said = sysid(*words)
    assert said.code == 0
    assert "Dask is not installed" in said.err
    assert "one after the other in this process" in said.err
    place = words.index("--workers")
    alone = [*words[:place], *words[place + 2 :]]
    said = sysid(*alone, "--scheduler", "tcp://127.0.0.1:1")
    assert (said.code, 'pip install "sysid[cluster]"' in said.err) == (1, True)


@pytest.mark.parametrize(
    "words",
    [
        ["--one", "one:30003", "-o", "out"],
        ["--one", "one:30003", "--regime", "one"],
        ["plan.toml", "--seed", "3", "-o", "out"],
        ["plan.toml", "--rows", "rows.jsonl", "-o", "out"],
        ["--rows", "rows.jsonl", "-o", "out", "--workers", "2"],
        ["--rows", "rows.jsonl", "-o", "out", "--scheduler", "tcp://127.0.0.1:1"],
        ["--rows", "rows.jsonl", "-o", "out", "--seed", "3"],
    ],
)
def test_an_option_that_would_be_ignored_is_wrong_usage(words, sysid, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = sysid("trials", *words)
    assert said.code == 2
    assert list(tmp_path.iterdir()) == []


def test_rows_of_another_program_are_made_anew(quick, sysid, tmp_path):
    file = tmp_path / "out" / "trials.jsonl"
    assert sysid(*order(tmp_path / "out")).code == 0
    rows = [row | {"program": "0123456789ab"} if row["id"] == "one:30001" else row
            for row in read_rows(file)]  # fmt: skip
    file.write_text("".join(json.dumps(row) + "\n" for row in rows))
    quick.clear()
    assert sysid(*order(tmp_path / "out")).code == 0
    assert quick == [("one", 30001)]


@pytest.mark.parametrize(
    ("words", "advice"), [(["none.toml"], "Give the path of a plan"),
                          (["--rows", "none.jsonl"], "Give the path of a trials.jsonl")],
)  # fmt: skip
def test_a_plan_or_results_that_are_not_there_are_named(words, advice, sysid, tmp_path):
    said = sysid("trials", *words, "-o", tmp_path / "out")
    assert said.code == 1
    assert f"{words[-1]}: " in said.err
    assert "o such file" in said.err
    assert advice in said.err
    assert not (tmp_path / "out").exists()


def test_results_without_their_plan_are_not_gone_on_with(quick, sysid, tmp_path):
    assert sysid(*order(tmp_path / "out")).code == 0
    (tmp_path / "out" / "plan.json").unlink()
    said = sysid(*order(tmp_path / "out"))
    assert (said.code, "holds trials but no sealed plan" in said.err) == (1, True)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('{"id": "none:10000"}', "none:10000 is no result of a trial (regime: field required)"),
        ('{"id": "none:3"}', "seed 3 does not belong to none"),
    ],
)
def test_a_line_that_is_no_result_is_told_with_its_place(line, message, sysid, tmp_path):
    file = tmp_path / "bad.jsonl"
    file.write_text(f"\n{line}\n")
    said = sysid("trials", "--rows", file, "-o", tmp_path / "page")
    assert said.code == 1
    assert f"bad.jsonl, line 2: {message}" in " ".join(said.err.split())
    assert not (tmp_path / "page").exists()


@pytest.mark.parametrize("words", [["--count", 20000], ["--seed", 20000],
                                   ["--seed", 6000, "--count", 6000]])  # fmt: skip
def test_more_trials_than_a_regime_has_are_wrong_usage(words, sysid, tmp_path):
    said = sysid("trials", "--regime", "none", *words, "-o", tmp_path / "out")
    assert (said.code, "10000 trials" in said.err) == (2, True)
    assert not (tmp_path / "out").exists()


def test_a_mechanism_that_was_taken_out_is_told_as_such(sysid, monkeypatch):
    def run(trial, diagnose, unfit):
        return Row("physical", trial.seed, 80, ("play",), (), (1.0,), 0.0, answer="named",
                   score=score_physical((named("coil_lag"),), {"play": 0.0}))  # fmt: skip

    monkeypatch.setattr("sysid.trials.one.run_physical", run)
    said = sysid("trials", "--one", "physical:100000:effect=play:level=0")
    assert said.code == 0
    assert "Hidden: play (1 % of the RMS force); it was taken out" in said.out
    assert "Judged: a false name was given" in said.out, "the current is constant"
