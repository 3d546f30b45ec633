"""Pages: links hold in the repository and on the site, the catalogue is what the code says."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sysid.effects.registry import EFFECTS, effect_kind
from tests.structure.pages import DOCS, PAGES, ROOT

LARGEST_FIGURE = 15_000


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, by the rule of repository pages."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    bare = [re.sub(r"[^\w\- ]", "", heading.strip().lower()) for heading in headings]
    return {heading.replace(" ", "-") for heading in bare}


def links(page: Path) -> list[str]:
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return re.findall(r"\[[^\]]*\]\(([^)\s]+)\)", text)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_hold_in_the_repository(page):
    for link in links(page):
        if "://" in link:
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        assert target.is_relative_to(ROOT), link
        if anchor:
            assert anchor in anchors(target), link


@pytest.mark.slow  # all pages with the API: ten seconds
def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("mkdocs", reason='needs pip install ".[docs]"')
    pytest.importorskip("mkdocstrings_handlers.python", reason='needs pip install ".[docs]"')
    call = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    api = (tmp_path / "api" / "diagnosis.html").read_text(encoding="utf-8")
    assert "diagnose_loops" in api
    assert (tmp_path / "results" / "trials.html").exists()
    method = (tmp_path / "method.html").read_text(encoding="utf-8")
    assert 'href="results/trials.html"' in method


@pytest.fixture(scope="module")
def catalogue():
    spec = importlib.util.spec_from_file_location("build_catalogue", DOCS / "build_catalogue.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "build_catalogue", module)
        spec.loader.exec_module(module)
        yield module


def test_the_catalogue_is_what_the_effects_declare(catalogue):
    written = (DOCS / "catalogue.md").read_text(encoding="utf-8")
    assert written == catalogue.page(), "run: python docs/build_catalogue.py"


def test_every_effect_has_a_small_figure_with_units():
    folder = DOCS / "images" / "effects"
    assert {path.stem for path in folder.iterdir()} == {kind.facts.id for kind in EFFECTS}
    for path in folder.iterdir():
        drawn = path.read_text(encoding="utf-8")
        assert len(drawn.encode()) < LARGEST_FIGURE, path.name
        for label in ("velocity, m/s", "force, N", "phase, °", "added force, N"):
            assert f">{label}<" in drawn, f"{label} in {path.name}"


@pytest.mark.parametrize(
    ("effect", "rms"),
    [
        ("gas_spring", 1500.0 * 12.5e-3 / np.sqrt(2.0)),
        ("force_offset", 20.0),
        ("linear_viscosity", 200.0 * 12.5e-3 * 5.0 * np.pi / np.sqrt(2.0)),
    ],
)
def test_figures_show_what_a_hand_would_compute(catalogue, effect, rms):
    kind = effect_kind(effect)
    facts = kind.facts
    scale = facts.nominal[facts.size] / {"gas_spring": 1500.0, "force_offset": 20.0}.get(
        effect, 200.0
    )
    assert catalogue.signature_of(kind).rms == pytest.approx(scale * rms, rel=1e-3)
    drawn = (DOCS / "images" / "effects" / f"{effect}.svg").read_text(encoding="utf-8")
    assert f"RMS {scale * rms:.3g} N," in drawn
