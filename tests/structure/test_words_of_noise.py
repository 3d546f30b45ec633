"""One word each for the scatter of one cycle and for the noise of the mean cycle, wherever read."""

import ast
import json
import re
from pathlib import Path

import pytest

from tests.structure.pages import PAGES, ROOT

NEITHER = re.compile(r"noise[\s-]+floors?\b", re.IGNORECASE)
"""It was said of both."""
RESULTS = sorted((ROOT / "benchmarks" / "results").glob("*.md"))
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
MODULES = sorted(
    p for part in ("cli", "report", "cards", "data") for p in (ROOT / "sysid" / part).rglob("*.py")
)


def sentences(module: Path) -> list[str]:
    """Strings of a module: what it prints, draws and helps with."""
    tree = ast.parse(module.read_text(encoding="utf-8"))
    return [
        n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)
    ]


@pytest.mark.parametrize("page", [*PAGES, *RESULTS], ids=lambda p: p.relative_to(ROOT).as_posix())
def test_no_page_has_one_word_for_both(page):
    assert not NEITHER.search(page.read_text(encoding="utf-8"))


@pytest.mark.parametrize("book", NOTEBOOKS, ids=lambda path: path.stem)
def test_no_notebook_does(book):
    for cell in json.loads(book.read_text(encoding="utf-8"))["cells"]:
        assert not NEITHER.search("".join(cell["source"]))


def test_no_command_and_no_figure_does():
    said = [(module.name, text) for module in MODULES for text in sentences(module)]
    assert len(said) > 1000
    assert [z for z in said if NEITHER.search(z[1])] == []


def test_both_words_are_explained():
    method = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
    for word in ("repeatability", "noise of the mean cycle"):
        assert f"| {word} |" in method
