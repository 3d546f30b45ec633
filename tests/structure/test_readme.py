"""README and CI say what is true of the program."""

import re
import shlex
from pathlib import Path

import pytest
import typer.main
from rich.text import Text

from sysid.cli.app import app

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()
COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]  # a click group


def shown_commands():
    blocks = re.findall(r"```\n(.*?)```", README, flags=re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    calls = [part.strip() for line in lines for part in line.split("&&")]
    return [c.replace(".venv/bin/", "") for c in calls if re.match(r"(\.venv/bin/)?sysid ", c)]


def test_there_are_commands_to_check():
    assert len(shown_commands()) >= 5


@pytest.mark.parametrize("call", shown_commands())
def test_every_shown_command_and_option_exists(call):
    words = shlex.split(call)[1:]
    command = COMMANDS[words[0]]
    known = {name for parameter in command.params for name in parameter.opts}
    for word in words[1:]:
        if word.startswith("-"):
            assert word in known, f"{word} of {call}"


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_in_the_readme_and_helps(name):
    assert f"`sysid {name} " in README
    assert COMMANDS[name].help
    for parameter in COMMANDS[name].params:
        if parameter.param_type_name == "option" and "--help" not in parameter.opts:
            assert parameter.help, f"{parameter.opts} of {name}"


@pytest.mark.parametrize("name", COMMANDS)
def test_no_bracket_of_the_help_is_taken_for_markup(name):
    for parameter in COMMANDS[name].params:
        text = getattr(parameter, "help", None) or ""
        shown = Text.from_markup(text).plain
        assert shown == text.replace("\\[", "["), f"{parameter.opts} of {name}"


def test_shipped_paths_in_the_readme_exist():
    for path in re.findall(
        r"\]\(([\w./-]+)\)|`?((?:datasets|docs|benchmarks|fits)/[\w./-]+)", README
    ):
        name = (path[0] or path[1]).rstrip("./")
        assert (ROOT / name).exists(), name


def test_ci_installs_and_tests_as_the_readme_does():
    test_command = next(line for line in README.splitlines() if "-m pytest" in line)
    install = re.search(r"pip install --quiet (.*?) &&", test_command).group(1)
    ci = (ROOT / ".ci" / "run").read_text()
    assert install in ci
    assert "-m pytest" in ci


def test_constraints_are_names_and_versions_only():
    for line in (ROOT / "constraints.txt").read_text().splitlines():
        assert re.fullmatch(r"[A-Za-z0-9_.-]+==[\w.]+", line), line
