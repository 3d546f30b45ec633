"""Work files of long studies: what is finished counts, what was cut off is done again."""

import pytest
import study
from study import run_study
from work_file import add_row, each_misfit, put_aside, read_rows

from sysid.errors import OutputError
from sysid.jobs.rows import shortened
from sysid.trials.program import fingerprint, meaning
from tests.jobs import chores


def test_rows_come_back_and_a_line_that_was_cut_off_spoils_no_other(tmp_path):
    file = tmp_path / "build" / "study.jsonl"
    assert read_rows(file) == []
    add_row({"seed": 1, "größe": 2.5}, file)
    add_row({"seed": 2}, file)
    with file.open("a", encoding="utf-8") as out:
        out.write('{"seed": 3, "hi')
    assert read_rows(file) == [{"seed": 1, "größe": 2.5}, {"seed": 2}]
    add_row({"seed": 3}, file)
    assert [row["seed"] for row in read_rows(file)] == [1, 2, 3]


def test_only_rows_that_are_missing_are_made_and_every_one_is_kept(tmp_path):
    file, made = tmp_path / "study.jsonl", []

    def one(seed, misfit):
        made.append((seed, misfit))
        return {"seed": seed, "misfit": misfit, "found": seed + misfit}

    add_row({"seed": 2, "misfit": 0.0, "found": "before"}, file)
    rows = list(each_misfit(one, (1, 2), (0.0, 2.0), file))
    assert made == [(1, 0.0), (1, 2.0), (2, 2.0)]
    assert [row["found"] for row in rows] == [1.0, 3.0, "before", 4.0]
    assert len(read_rows(file)) == 4
    assert list(each_misfit(one, (1, 2), (0.0, 2.0), file)) == rows
    assert len(made) == 3
    list(each_misfit(one, (1,), (0.0,), None))
    assert len(made) == 4, "without a file nothing is read"


def test_rows_of_another_program_are_put_aside(tmp_path):
    file, aside = tmp_path / "work.jsonl", tmp_path / "aside.jsonl"
    for seed, program in ((1, "old"), (2, "new"), (3, "old")):
        add_row({"seed": seed, "program": program}, file)
    put_aside(file, {"new"}, aside)
    put_aside(file, {"new"}, aside)
    assert [r["seed"] for r in read_rows(file)] == [2]
    assert [r["seed"] for r in read_rows(aside)] == [1, 3]


def test_rows_are_kept_with_few_digits():
    assert shortened({"a": [1 / 3, 2, None], "b": ("x", 1e-9 / 3)}) == {
        "a": [0.33333, 2, None], "b": ["x", 3.3333e-10],
    }  # fmt: skip


def test_a_program_is_what_its_code_says_not_how_it_looks():
    one = 'def f(x):\n    """Old words."""\n    return x + 1  # why\n'
    assert meaning(one) == meaning('def f(x):\n    "New."\n\n    return (x + 1)\n')
    assert meaning(one) != meaning(one.replace("1", "2"))


def test_a_fingerprint_is_of_the_named_parts():
    assert fingerprint(["units.py"]) == fingerprint(["units.py"])
    assert fingerprint(["rig"], but=["rig/physical"]) != fingerprint(["rig"])
    with pytest.raises(FileNotFoundError):
        fingerprint(["no_such_module.py"])


def test_a_study_that_starts_during_another_is_refused_before_anything_is_put_aside(
    tmp_path, monkeypatch
):
    pytest.importorskip("fcntl")
    file = tmp_path / "work.jsonl"
    monkeypatch.setattr(study, "FOLDER", tmp_path / "aside")
    monkeypatch.setattr(study, "prepare_to_diagnose", chores.nothing)
    add_row({"id": "p0", "program": "before"}, file)

    def run(program, work):
        def made(name):
            return work(name) | {"id": name, "program": program}

        return run_study(["p0", "p1"], made, file, program, processes=1, words=str)

    def second(name):
        with pytest.raises(OutputError, match="written by another run"):
            run("new", lambda _: {})
        return {}

    assert run("old", second).new == 2
    assert [(r["id"], r["program"]) for r in read_rows(file)] == [("p0", "old"), ("p1", "old")]
    assert [r["program"] for r in read_rows(tmp_path / "aside" / "work_aside.jsonl")] == ["before"]
    assert run("new", lambda _: {}).new == 2
    assert {path.name for path in tmp_path.iterdir()} == {"work.jsonl", "aside"}
