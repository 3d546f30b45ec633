"""Every notebook runs from top to bottom, draws its figures, and is stored without outputs."""

import ast
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((REPOSITORY / "notebooks").glob("*.ipynb"))
FIGURES = {
    "00_the_papers_figures": 10,
    "01_first_fit_from_a_folder": 4,
    "02_temperature_sweeps_and_the_bias_of_straight_lines": 3,
    "03_what_is_wrong_and_why": 5,
    "04_how_sure_are_we": 2,
    "05_real_measurements": 4,
    "06_what_it_is_worth_to_a_controller": 2,
    "07_write_your_own_effect": 2,
}
"""How many figures each draws."""
MEASURED = (
    REPOSITORY / "datasets" / "utfsm",
    REPOSITORY.parent / "shared" / "data" / "utfsm",
)
WORDS = 2500
"""Prose and code: ten minutes of reading."""


def read(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text(encoding="utf-8"))


def code(path: Path) -> list[str]:
    return ["".join(c["source"]) for c in read(path)["cells"] if c["cell_type"] == "code"]


def test_all_of_them_are_known():
    assert [path.stem for path in NOTEBOOKS] == sorted(FIGURES)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem[:2])
def test_it_is_stored_without_outputs(path):
    raw = read(path)
    assert (raw["nbformat"], raw["nbformat_minor"]) == (4, 5)
    assert len({cell["id"] for cell in raw["cells"]}) == len(raw["cells"])
    for cell in raw["cells"]:
        assert cell["metadata"] == {}
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem[:2])
def test_it_says_first_what_will_be_seen_and_is_short(path):
    cells = read(path)["cells"]
    assert cells[0]["cell_type"] == "markdown"
    assert "**You will see:**" in "".join(cells[0]["source"])
    assert sum(len("".join(cell["source"]).split()) for cell in cells) < WORDS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem[:2])
def test_what_computes_is_in_the_package(path):
    """Calls only: a few lines that choose tests at most, and the class that notebook 7 is about."""
    tree = ast.parse("\n".join(code(path)))
    assert not [z for z in ast.walk(tree) if isinstance(z, ast.While | ast.Lambda | ast.Try)]
    functions = [z for z in tree.body if isinstance(z, ast.FunctionDef)]
    assert all(len(z.body) <= 6 for z in functions)
    assert len(functions) <= 2
    classes = [z.name for z in tree.body if isinstance(z, ast.ClassDef)]
    assert classes == (["FadingField"] if path.stem.startswith("07") else [])


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem[:2])
def test_the_package_has_what_it_imports(path):
    """Told in a second, where running the notebook takes half a minute and is marked slow."""
    tree = ast.parse("\n".join(code(path)))
    asked = [z for z in ast.walk(tree) if isinstance(z, ast.ImportFrom)]
    assert asked
    for one in asked:
        exec(ast.unparse(one), {})


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem[:2])
def test_it_runs_and_draws(path):
    runner = str(Path(__file__).with_name("run_notebook.py"))
    done = subprocess.run(
        [sys.executable, "-W", "error", runner, path.name],
        cwd=path.parent, capture_output=True, text=True, timeout=300,
        env=os.environ | {"PYTHONPATH": str(REPOSITORY)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    figures = json.loads(done.stdout.splitlines()[-1])
    absent = path.stem.startswith("05") and not any(any(z.glob("*.csv")) for z in MEASURED)
    assert len(figures) == (0 if absent else FIGURES[path.stem])
    assert absent == ("are not here" in done.stdout)
    for axes, labelled, things in figures:
        assert axes >= 1
        assert labelled >= 1
        assert things >= axes


def test_the_effect_of_notebook_7_is_sixty_lines():
    """What a user writes to have an effect of his own: well below the sixty that are promised."""
    (text,) = [cell for cell in code(REPOSITORY / "notebooks" / "07_write_your_own_effect.ipynb")
               if "class FadingField" in cell]  # fmt: skip
    assert len(text.splitlines()) < 60
