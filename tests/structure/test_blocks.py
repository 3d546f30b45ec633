"""Every command and every block of README and pages is run, or taken apart where it is long.

Run for real, in a folder that holds what the pages speak of: `check`, `simulate`, `validate`,
`export`, the C compiler, every Python block, every manifest, list and plan. The tutorial is run
from its first to its last command, and what it says comes out. Only taken apart (the command
exists, its options and values are valid, its inputs are there), because they take from ten seconds
to hours:

- `fit`, `diagnose`, `next`: run by the tutorial, and by tests/cli. Of the tutorial, blocks that are
  marked as long run where SYSID_LONG is set in the environment;
- `trials`, `rig`, `isolator`, `fit --each`: run by tests/cli, tests/rig and tests/isolator;
- `pip`, `venv`, `pytest`: run by .ci/run; `mkdocs`: by test_docs.py; `dask`: needs other machines.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
import typer.main

from sysid.cli.app import app, run
from sysid.cli.options import join_ranges
from sysid.data.listing import read_listing
from sysid.data.manifest import read_manifest
from sysid.trials.plan import read_plan
from tests.structure.pages import DOCS, PAGES, ROOT, Block, blocks, commands

COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]  # a click group
BLOCKS = blocks()
TUTORIAL = DOCS / "tutorial.md"
RUN = ("check", "simulate", "validate", "export")
EXPECTED_CODE = {"sysid check turned-tests": 3}
ELSEWHERE = ("pip", "python3", "mkdocs", "dask")
"""First words of commands that are run elsewhere, or need other machines."""
PROGRAMS = ("sysid", "python", "python3", "pip", "cc", "./test", "dask", "mkdocs")
DRAWINGS = {"architecture", "export"}
"""Pages that hold drawings or an equation in blocks without a language."""


def first_word(call: str) -> str:
    words = shlex.split(call)
    return next((word for word in words if "=" not in word), "")


def is_commands(block: Block) -> bool:
    return block.language == "" and first_word(commands(block)[0]) in PROGRAMS


SHOWN = [
    pytest.param(block.page, call, id=f"{block.page.stem}: {call[:60]}")
    for block in BLOCKS
    if is_commands(block) and block.page != TUTORIAL
    for call in commands(block)
]
OTHERS = [b for b in BLOCKS if not is_commands(b) and b.page != TUTORIAL]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with the campaigns, cards and plans that the pages name."""
    folder = tmp_path_factory.mktemp("pages")
    (folder / "datasets").symlink_to(ROOT / "datasets")
    low = ROOT / "datasets" / "virtual-w11-low"
    few = ("12.5mm_1.5Hz_0.2A.csv", "12.5mm_2.5Hz_0.2A.csv", "campaign.toml")
    for name in ("my-tests", "other-tests", "turned-tests", "fleet/one"):
        (folder / name).mkdir(parents=True)
        for file in few:
            shutil.copy(low / file, folder / name / file)
    for path in (folder / "turned-tests").glob("*.csv"):
        test = pd.read_csv(path)
        test["force_N"] *= -1.0
        test.to_csv(path, index=False)
    for name in ("out", "diagnosis", "sweep"):
        (folder / name).mkdir()
        shutil.copy(ROOT / "fits" / "virtual-w11-low" / "card.json", folder / name)
    plan = next(b for b in BLOCKS if b.language == "toml" and "[[trials]]" in b.text)
    (folder / "plan.toml").write_text(plan.text, encoding="utf-8")
    return folder


@pytest.fixture
def inside(place, monkeypatch):
    monkeypatch.chdir(place)
    return place


def take_apart(words: list[str]) -> None:
    """Options and values as the command itself reads them; its inputs are there."""
    command = COMMANDS[words[0]]
    with command.make_context(words[0], join_ranges(words[1:])) as context:
        for name in ("campaign", "card", "plan"):
            given = context.params.get(name)
            if given is not None:
                assert Path(str(given)).exists(), given


@pytest.mark.parametrize(("page", "call"), SHOWN)
def test_shown_commands_run(inside, page, call, capsys):
    words = shlex.split(call)
    while "=" in words[0]:
        words.pop(0)
    program, arguments = words[0], words[1:]
    if program == "sysid":
        if arguments[0] in RUN:
            code = run(arguments)
            assert code == EXPECTED_CODE.get(call, 0), capsys.readouterr().err
        else:
            take_apart(arguments)
    elif program == "python":
        assert arguments[0] == "-m" or (ROOT / arguments[0]).exists()
    elif program in ("cc", "./test"):
        pass  # both together, below
    else:
        assert program in ELSEWHERE


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
@pytest.mark.parametrize("page", ["export.md", "how-to/card-in-my-simulator.md"])
def test_the_exported_program_is_built_and_run_as_shown(inside, monkeypatch, tmp_path, page):
    """In a folder of its own: the page's export to C, the compiler, the test program."""
    text = (DOCS / page).read_text(encoding="utf-8")
    (export,) = re.findall(r"^sysid export .* --to c .*$", text, re.MULTILINE)
    (compiled,) = re.findall(r"\bcc -o .* -lm\b", text)
    (tmp_path / "out").symlink_to(inside / "out")
    monkeypatch.chdir(tmp_path)
    assert run(shlex.split(export)[1:]) == 0
    subprocess.run(shlex.split(compiled), check=True)
    assert "./test" in text
    done = subprocess.run(["./test"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("block", OTHERS, ids=lambda block: block.name)
def test_other_blocks_are_what_they_seem(inside, tmp_path, block):
    if block.language == "toml":
        path = tmp_path / "campaign.toml"
        path.write_text(block.text, encoding="utf-8")
        _ = read_plan(path) if "[[trials]]" in block.text else read_manifest(path)
    elif block.language == "csv":
        path = tmp_path / "tests.csv"
        path.write_text(block.text, encoding="utf-8")
        assert len(read_listing(path).tests) == len(block.text.strip().splitlines()) - 1
    elif block.language == "python":
        exec(compile(block.text, block.name, "exec"), {})
    elif block.language == "":
        assert block.page.stem in DRAWINGS
        assert not any(first_word(line) in PROGRAMS for line in block.text.splitlines() if line)
    else:
        assert block.language == "text", "equations and declarations"


def test_indented_commands_exist():
    shown = [
        line.split()
        for page in PAGES
        for line in re.findall(r"^    (sysid .*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    for words in shown:
        take_apart([words[1], words[2], "-o", "DIR"])
    assert shown


def inline_commands() -> set[str]:
    """Commands in running text, `sysid …` between backticks."""
    found: set[str] = set()
    for page in PAGES:
        text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        found |= set(re.findall(r"`(sysid [a-z][^`\n]*|python (?:benchmarks|docs)/[^`\n]*)`", text))
    return found


@pytest.mark.parametrize("call", sorted(inline_commands()))
def test_commands_in_running_text_exist(call):
    words = shlex.split(call)
    if words[0] == "python":
        assert (ROOT / words[1]).exists()
        return
    command = COMMANDS[words[1]]
    known = {name for parameter in command.params for name in parameter.opts}
    known |= {name for parameter in command.params for name in parameter.secondary_opts}
    assert {word for word in words[2:] if word.startswith("-")} <= known


SAID = {
    "sysid check": (),
    "sysid fit": ("fitted tests 0.56%", "not determined"),
    "sysid validate out/card.json": ("Mean RMSE/max|F| 2.01%",),
    "sysid diagnose": (
        "A gas spring, 1.500 ± 0.017 kN/m",
        "An offset of the force (static gas force or load-cell zero), 5.1 ± 1.2 N",
        "lowers the held-out error from 2.0 % to 0.67 % of the peak force",
    ),
    "sysid next": (
        "no explanations that a simulated test could tell apart",
        "a force law that depends on frequency. Repeat the same speeds at other frequencies: "
        "1.3 mm at 5 Hz and 3.8 mm at 5 Hz",
    ),
    "sysid validate diagnosis/card.json": ("Mean RMSE/max|F| 0.52%",),
}
"""Beginning of a command → what it must print, because the tutorial says so."""


@pytest.mark.slow  # fits and a diagnosis
def test_the_tutorial_from_first_to_last_command(tmp_path):
    (tmp_path / "datasets").symlink_to(ROOT / "datasets")
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1", "COLUMNS": "300"}
    program = [sys.executable, "-c", "from sysid.cli.app import main; main()"]
    met = set()
    everything = "SYSID_LONG" in os.environ
    for block in [b for b in BLOCKS if b.page == TUTORIAL]:
        if block.long and not everything:
            for call in commands(block):
                assert shlex.split(call)[1] in COMMANDS
            continue
        if block.language == "python":
            calls = [[sys.executable, "-c", block.text]]
        else:
            calls = [[*program, *shlex.split(call)[1:]] for call in commands(block)]
        for words in calls:
            done = subprocess.run(
                words, cwd=tmp_path, env=environment, capture_output=True, text=True
            )
            assert done.returncode == 0, done.stderr
            shown = "sysid " + " ".join(words[3:])
            for beginning, sentences in SAID.items():
                if shown.startswith(beginning):
                    met.add(beginning)
                    for sentence in sentences:
                        assert sentence in done.stdout, f"{shown}: {done.stdout[-3000:]}"
    assert met == {said for said in SAID if everything or "diagnos" not in said} - (
        set() if everything else {"sysid next"}
    )
