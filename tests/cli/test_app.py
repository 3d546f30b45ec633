"""The command line as a whole: help, exit codes, one error boundary."""

import errno
import json
import os
import subprocess
import sys
from io import BytesIO, TextIOWrapper
from pathlib import Path

import pytest
import typer

from sysid import __version__
from sysid.cli import app as module
from sysid.cli.console import Talk
from sysid.errors import DataError

REPOSITORY = Path(__file__).parents[2]
HEAVY = ("jax", "pandas", "scipy", "matplotlib", "equinox", "optimistix", "plotly", "jinja2")
COMMANDS = typer.main.get_command(module.app).commands  # pyright: ignore[reportAttributeAccessIssue]


def in_new_process(*arguments: str, before: str = "") -> list[str]:
    """Heavy modules that a command loads, as seen in a fresh interpreter."""
    program = (
        f"import sys, json, io\n{before}\nfrom sysid.cli.app import run\n"
        f"code = run({list(arguments)!r})\n"
        f"print(json.dumps([code, sorted(set(sys.modules) & set({HEAVY!r}))]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=REPOSITORY
    )
    code, loaded = json.loads(done.stdout.splitlines()[-1])
    assert code == 0
    return loaded


@pytest.mark.parametrize(
    "arguments", [[], ["--help"], ["--version"], ["fit", "--help"], ["diagnose", "--help"]]
)
def test_help_loads_nothing_heavy(arguments):
    assert in_new_process(*arguments) == []


def test_alone_it_shows_where_to_begin(sysid):
    said = sysid()
    assert said.code == 0
    for command in ("check", "fit", "diagnose", "simulate", "validate"):
        assert f"sysid {command}" in said.out
    assert sysid("--version").out == f"sysid {__version__}\n"


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_command_and_option_is_explained(name, sysid):
    command = COMMANDS[name]
    assert command.help
    for parameter in command.params:
        assert getattr(parameter, "help", None), parameter.name
    options = {opt for parameter in command.params for opt in parameter.opts}
    assert {"--json", "--seed", "--quiet"} <= options
    said = sysid(name, "--help")
    assert said.code == 0
    assert all(opt in said.out for opt in options if opt.startswith("--"))


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_command_is_in_the_readme(name):
    assert f"sysid {name}" in (REPOSITORY / "README.md").read_text(encoding="utf-8")


def test_the_commands_of_the_contract_are_there():
    assert {"check", "fit", "diagnose", "simulate", "validate", "rig"} <= set(COMMANDS)


@pytest.mark.parametrize(
    "arguments",
    [
        ["fly"],
        ["fit"],
        ["fit", "campaign"],
        ["fit", "campaign", "-o", "out", "--model", "maxwell"],
        ["fit", "campaign", "-o", "out", "--variant", "skewed"],
        ["fit", "campaign", "-o", "out", "--seed", "one"],
        ["fit", "campaign", "-o", "out", "--frequency-range", "1"],
        ["fit", "campaign", "-o", "out", "--frequency-range", "5", "1"],
        ["fit", "campaign", "-o", "out", "--amplitude-range", "1Hz", "2Hz"],
        ["fit", "campaign", "-o", "out", "--each", "--manifest", "m.toml"],
        ["simulate", "card.json", "-o", "f.csv"],
        ["validate", "card.json"],
        ["check", "--nothing"],
    ],
)
def test_wrong_usage_is_exit_2_with_one_message(arguments, sysid, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = sysid(*arguments)
    assert (said.code, said.out) == (2, "")
    assert said.err.startswith("Usage error: ")
    assert "--help" in said.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (
            DataError("is empty", where="a.csv", advice="Export it"),
            1,
            "Error: a.csv: is empty",
        ),
        (KeyboardInterrupt(), 130, "Stopped before the end"),
        (MemoryError(), 1, "Error: not enough memory"),
        (OSError(errno.ENOSPC, "No space left on device", "/x/y"), 1, "Error: /x/y: No space left"),
        (ZeroDivisionError("division by zero"), 1, "internal fault of sysid (ZeroDivisionError"),
    ],
)
def test_every_failure_is_one_message(error, code, message, sysid, monkeypatch, tmp_path):
    def fail(*args, **kwargs):
        raise error

    monkeypatch.setattr("sysid.data.campaign.load_campaign", fail)
    said = sysid("check", tmp_path)
    assert (said.code, said.out) == (code, "")
    assert message in said.err
    assert said.err.strip().count("\n") <= 1


def test_a_defect_shows_its_traceback_only_when_asked(monkeypatch, capsys, tmp_path):
    def fail(*args, **kwargs):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("sysid.data.campaign.load_campaign", fail)
    monkeypatch.setenv("SYSID_TRACEBACK", "1")
    assert module.run(["check", str(tmp_path)]) == 1
    assert "Traceback" in capsys.readouterr().err


def test_a_reader_that_goes_away_is_no_error_message():
    program = (
        "from sysid.cli import app; app.START = 'x' * 10_000_000\nimport sys; sys.exit(app.run([]))"
    )
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-c", program], stdout=write, stderr=subprocess.PIPE, cwd=REPOSITORY
    )
    os.close(write)
    assert done.returncode == 1
    assert done.stderr.strip() == b""


def test_without_a_place_for_compiled_programs_it_goes_on(sysid, card_file, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    order = ["simulate", card_file, "--amplitude", "12.5mm", "--frequency", "1Hz"]
    order += ["--current", "0A", "-o", tmp_path / "f.csv"]
    said = sysid(*order)
    assert said.code == 0
    assert "every run starts cold" in said.err
    assert sysid(*order, "--quiet").err == ""


def test_json_is_utf_8_whatever_the_locale(monkeypatch):
    raw = BytesIO()
    monkeypatch.setattr(sys, "stdout", TextIOWrapper(raw, encoding="cp1252", errors="replace"))
    Talk(json=True).result({"id": "Dämpfer 40°C γ R̂"})
    assert json.loads(raw.getvalue().decode("utf-8")) == {"id": "Dämpfer 40°C γ R̂"}
