"""What is installed is whole: wheel and sdist are built without a network, and looked into."""

import importlib.metadata
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml

import sysid

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
BUILD = "import sys; from setuptools import build_meta as b; getattr(b, sys.argv[1])(sys.argv[2])"


def files_of_the_package() -> set[str]:
    return {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "sysid").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """A folder with both archives, built from a copy of the sources."""
    try:
        version = int(importlib.metadata.version("setuptools").split(".")[0])
    except importlib.metadata.PackageNotFoundError:
        version = 0
    if version < 77:
        pytest.skip("pyproject.toml needs setuptools 77 or newer to be built")
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("built")
    without_caches = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "sysid", source / "sysid", ignore=without_caches)
    for name in (
        "pyproject.toml", "README.md", "LICENSE", "MANIFEST.in", "CITATION.cff", "CHANGELOG.md",
        "constraints.txt",
    ):  # fmt: skip
        shutil.copy(ROOT / name, source)
    for hook in ("build_wheel", "build_sdist"):
        call = [sys.executable, "-c", BUILD, hook, str(out)]
        done = subprocess.run(call, cwd=source, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[-3000:]
    return out


def test_the_wheel_holds_every_file_of_the_package(built):
    (path,) = built.glob("*.whl")
    assert path.name == f"sysid-{PROJECT['version']}-py3-none-any.whl"
    with zipfile.ZipFile(path) as wheel:
        names = set(wheel.namelist())
        (metadata,) = (n for n in names if n.endswith(".dist-info/METADATA"))
        said = wheel.read(metadata).decode()
        entries = wheel.read(metadata.replace("METADATA", "entry_points.txt")).decode()
    inside = {name for name in names if name.startswith("sysid/")}
    assert inside == files_of_the_package()
    assert "sysid/py.typed" in inside, "type information is shipped"
    assert {name.split("/")[0] for name in names if ".dist-info" not in name} == {"sysid"}
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert "License-Expression: MIT" in said
    assert "sysid = sysid.cli.app:main" in entries


def test_the_sdist_holds_what_building_needs(built):
    (path,) = built.glob("*.tar.gz")
    with tarfile.open(path) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert files_of_the_package() <= names
    assert {"pyproject.toml", "README.md", "LICENSE", "CITATION.cff"} <= names


def test_the_program_runs_from_the_wheel_alone(built, tmp_path):
    """Schemas and C sources are found as package data, not in the working copy."""
    (path,) = built.glob("*.whl")
    with zipfile.ZipFile(path) as wheel:
        wheel.extractall(tmp_path / "site")
    card = ROOT / "fits" / "virtual-w11-low" / "card.json"
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r}); "
        "import sysid; from sysid.cli.app import run; "
        f"assert sysid.__file__.startswith({str(tmp_path)!r}), sysid.__file__; "
        f"sys.exit(run(['export', {str(card)!r}, '--to', 'c', '-o', 'damper.c']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tmp_path / "damper.c").exists()


def test_versions_and_licences_agree():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["version"] == PROJECT["version"] == sysid.__version__
    assert cited["license"] == PROJECT["license"] == "MIT"
    assert {"cff-version", "message", "title", "authors"} <= set(cited)
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").startswith("MIT License")
