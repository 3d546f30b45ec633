"""The page on architecture names every file of the package, and no file that is not there."""

import re
from pathlib import Path

import pytest

from tests.structure.pages import DOCS, ROOT

TEXT = (DOCS / "architecture.md").read_text(encoding="utf-8")
FENCES = re.findall(r"```.*?```", TEXT, flags=re.DOTALL)
SPANS = re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", TEXT, flags=re.DOTALL))
NAMES = set(re.findall(r"\w+", " ".join([*SPANS, *FENCES])))
ONE_IDEA_A_FILE = {
    "data/quality", "data/readers", "effects/channel", "effects/drive", "effects/force",
    "effects/law", "effects/motion", "identification/starts", "isolator/controllers",
    "rig/physical", "rig/planters", "rig/scenarios",
}  # fmt: skip
"""Folders whose files are named after what they hold: the page names the folder."""
ALIKE = ("_coordinates", "_json", "_plot")
"""Ends of names of files that the page names together."""
PACKAGE = ROOT / "sysid"
MODULES = [
    path.relative_to(PACKAGE) for path in sorted(PACKAGE.rglob("*.py")) if path.stem != "__init__"
]


@pytest.mark.parametrize("module", MODULES, ids=str)
def test_every_file_is_named(module: Path):
    folder = module.parent.as_posix()
    if folder in ONE_IDEA_A_FILE:
        assert f"`{folder}" in TEXT or folder.split("/")[-1] in NAMES
    elif not module.stem.endswith(ALIKE):
        assert module.stem in NAMES, f"{module} is not on docs/architecture.md"


def test_every_path_exists():
    paths = [span for span in SPANS if re.fullmatch(r"[\w.]+(/[\w.]+)+", span)]
    for path in paths:
        places = [ROOT / path, PACKAGE / path]
        assert any(p.exists() or p.with_suffix(".py").exists() for p in places), path
    assert paths
