"""The pictures of README: small, the same every time, and no photograph without a browser."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.structure.pages import ROOT


@pytest.fixture(scope="module")
def pictures():
    path = ROOT / "docs" / "build_pictures.py"
    found = importlib.util.spec_from_file_location("build_pictures", path)
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules["build_pictures"] = module
    found.loader.exec_module(module)
    yield module
    del sys.modules["build_pictures"]


def test_the_committed_pictures_are_small(pictures):
    for path in (pictures.STORY, pictures.SCREEN):
        assert path.is_file()
        assert 10_000 < path.stat().st_size < pictures.LARGEST
    assert pictures.SCREEN.read_bytes()[:4] == b"\x89PNG"


def test_the_story_is_drawn_the_same_every_time(pictures, tmp_path):
    phase = np.linspace(0.0, 2 * np.pi, 60)
    force = 300.0 * np.tanh(3 * np.cos(phase))
    story = pictures.Story(
        test="10 mm, 2 Hz, 0 A", velocity=0.1 * np.cos(phase), measured=force, before=0.8 * force,
        after=force, cause="a gas spring, 1.5 kN/m", hidden="1.5 kN/m", confidence=0.9,
        errors=(0.03, 0.01, 0.006), tests=24,
    )  # fmt: skip
    texts = []
    for name in ("a.svg", "b.svg"):
        pictures.draw_story(story, tmp_path / name)
        texts.append((tmp_path / name).read_text(encoding="utf-8"))
    assert texts[0] == texts[1]
    assert "<dc:date>" not in texts[0]
    for colour in (pictures.PAPER, "#d55e00", "#0072b2", "#9aa3ad"):
        assert colour in texts[0]


def test_without_a_browser_there_is_no_photograph(pictures, monkeypatch, tmp_path):
    monkeypatch.setattr(pictures, "find_browser", lambda: None)
    assert not pictures.photograph(Path("report.html"), tmp_path / "report.png")
    assert not (tmp_path / "report.png").exists()
