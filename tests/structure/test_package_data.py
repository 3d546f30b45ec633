"""Files that the program reads beside its own code are in its packages."""

import tomllib
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATTERNS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"][
    "package-data"
]["sysid"]


def test_everything_that_is_no_code_is_shipped():
    own = ROOT / "sysid"
    files = [p.relative_to(own).as_posix() for p in own.rglob("*") if p.is_file()]
    data = [f for f in files if not f.endswith((".py", ".pyc"))]
    assert any(f.endswith(".jinja") for f in data)
    assert [f for f in data if not any(fnmatch(f, pattern) for pattern in PATTERNS)] == []
