"""`sysid export` from a card to files."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from sysid.cards.write import write_card
from sysid.cli.app import run
from sysid.effects.registry import effect_kind, make
from tests.cards.example import card_with
from tests.cards.export.program import needs_compiler

CARD = Path(__file__).parents[2] / "fits" / "virtual-w11-asymmetric" / "card.json"


def test_c_is_checked_before_it_is_written_and_its_own_test_passes(tmp_path, capsys):
    assert run(["export", str(CARD), "--to", "c", "-o", str(tmp_path / "w11.c"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["w11.c", "w11.h", "w11_test.c"]
    if shutil.which("cc") is None:
        assert "no C compiler" in told["check"]
        assert told["agrees"] is None
        return
    assert told["agrees"]
    command = "cc -std=c99 -Wall -Werror -o test w11.c w11_test.c -lm && ./test"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("all agree\n")


@needs_compiler
def test_a_program_that_does_not_agree_is_distrusted(tmp_path, capsys, monkeypatch):
    from sysid.cards.export import c_program

    honest = c_program.signal_path
    monkeypatch.setattr(
        c_program,
        "signal_path",
        lambda p: honest(p).replace("return at->C_i *", "return 1.01 * at->C_i *"),
    )
    assert run(["export", str(CARD), "--to", "c", "-o", str(tmp_path / "w11.c")]) == 3
    assert "check vectors" in capsys.readouterr().err


@needs_compiler
def test_a_modelica_header_that_does_not_compile_is_distrusted(tmp_path, capsys, monkeypatch):
    """As where a function of it has the name of one of the source's own."""
    from sysid.cards.export import modelica

    honest = modelica.filled
    monkeypatch.setattr(
        modelica,
        "filled",
        lambda file, marks: honest(file, marks).replace("_modelica_force(", "_force("),
    )
    order = ["export", str(CARD), "--to", "modelica", "-o", str(tmp_path / "Generalized.mo")]
    assert run([*order, "--json"]) == 3
    assert not json.loads(capsys.readouterr().out)["agrees"]
    monkeypatch.undo()
    assert run([*order, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["check"].endswith("all agree")


def test_the_command_says_what_a_table_leaves_out(tmp_path, capsys):
    write_card(card_with(make(effect_kind("run_drift"))), tmp_path / "card.json")
    order = ["export", str(tmp_path / "card.json"), "--to", "csv", "-o", str(tmp_path / "t.csv")]
    assert run(order) == 0
    assert "Note: run_drift has no say here" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("to", "name", "said"),
    [
        ("c", "rd-1.c", "take rd_1.c"),
        ("c", "Damper.c", "take damper.c"),
        ("modelica", "damper.mo", "take Damper.mo"),
        ("fmu", "x.zip", "does not end in .fmu"),
        ("csv", "x.txt", "does not end in .csv"),
    ],
)
def test_a_file_that_cannot_be_so_named_is_wrong_usage(to, name, said, tmp_path, capsys):
    assert run(["export", str(CARD), "--to", to, "-o", str(tmp_path / name)]) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_every_other_format_is_written(tmp_path, capsys):
    for to, name, files in (
        ("fmu", "d.fmu", {"d.fmu"}),
        ("modelica", "Mr.mo", {"Mr.mo", "mr.c", "mr.h", "mr_modelica.h"}),
        ("csv", "t.csv", {"t.csv"}),
    ):
        folder = tmp_path / "new" / to
        assert run(["export", str(CARD), "--to", to, "-o", str(folder / name)]) == 0
        capsys.readouterr()
        assert {path.name for path in folder.iterdir()} == files


def test_a_card_that_is_none_is_one_message(tmp_path, capsys):
    bad = tmp_path / "card.json"
    bad.write_text("{")
    for card in (bad, tmp_path / "none.json"):
        assert run(["export", str(card), "--to", "c", "-o", str(tmp_path / "d.c")]) == 1
        said = capsys.readouterr().err
        assert str(card) in said
        assert "Traceback" not in said
    assert [path.name for path in tmp_path.iterdir()] == ["card.json"]


def test_what_was_not_built_is_not_said_to_agree(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sysid.cards.export.compiler.compiler", lambda: None)
    assert run(["export", str(CARD), "--to", "c", "-o", str(tmp_path / "w11.c"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["agrees"] is None
    assert "no C compiler" in told["check"]


def stub(folder: Path, script: str) -> str:
    """A C compiler that only runs a shell script; `$4` is the name of what it has to make."""
    path = folder / "stub-cc"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return str(path)


@pytest.mark.parametrize(
    ("script", "code", "agrees", "said"),
    [
        ("echo 'xcode-select: error: no tools' >&2; exit 1", 0, None, "error: no tools"),
        ("while [ $1 != -o ]; do shift; done; echo x > $2", 0, None, "not run: Permission denied"),
        (
            "case $* in *empty.c*) exit 0;; esac; printf 'In\\nw.c:3: error: odd\\n' >&2; exit 1",
            3, False, "w.c:3: error: odd",
        ),
    ],
    ids=["builds nothing", "may not be run", "refuses the source"],
)  # fmt: skip
def test_only_what_was_built_and_run_can_disagree(
    script, code, agrees, said, tmp_path, capsys, monkeypatch
):
    made = stub(tmp_path, script)
    monkeypatch.setattr("sysid.cards.export.compiler.compiler", lambda: made)
    order = ["export", str(CARD), "--to", "c", "-o", str(tmp_path / "w11.c")]
    assert run([*order, "--json"]) == code
    told = json.loads(capsys.readouterr().out)
    assert told["agrees"] is agrees
    assert said in told["check"]
    assert any(said in note for note in told["notes"]) == (agrees is None)
    assert (tmp_path / "w11.c").exists()


def test_a_compiler_that_cannot_be_started_is_no_disagreement(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sysid.cards.export.compiler.compiler", lambda: str(tmp_path / "gone"))
    order = ["export", str(CARD), "--to", "modelica", "-o", str(tmp_path / "Mr.mo"), "--json"]
    assert run(order) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["agrees"] is None
    assert "cannot be run: No such file" in told["check"]
