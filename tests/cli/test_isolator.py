"""`sysid isolator` as a user runs it."""

import json

import pytest

from sysid.cards.write import write_card
from sysid.effects.registry import effect_kind
from tests.cards.example import card_with
from tests.isolator.conftest import lumped_card

QUICK = ["--motions", "2", "--draws", "2", "--duration", "0.2s", "--controller", "P"]


@pytest.fixture(scope="module")
def lumped_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("card") / "card.json"
    write_card(lumped_card(checked=True), path)
    return path


def test_results_and_figures(sysid, lumped_file, tmp_path):
    said = sysid("isolator", lumped_file, "-o", tmp_path / "out", *QUICK, "--json", "--quiet")
    assert said.code in (0, 3)
    told = said.json
    assert told == json.loads((tmp_path / "out" / "isolator.json").read_text())
    assert told["trusted"] == (said.code == 0)
    assert told["runs"] == 9 * 7 * 2
    assert told["temperatures_degC"][0] == 15.0
    (one,) = told["cold_to_warm"]
    assert one["acceleration"]["value"] < 0.0 < one["working_space"]["value"]
    assert set(told["laws"]) == {"C_post", "F_y", "F_y without 0 A", "k", "all"}
    assert told["draws"]["count"] == 2
    (drawn,) = told["cold_to_warm_over_draws"]
    assert drawn["acceleration"]["low"] < drawn["acceleration"]["high"] < 0.0
    for name in ("conflict.png", "laws.png", "rig.png"):
        assert (tmp_path / "out" / name).read_bytes().startswith(b"\x89PNG")


def test_what_cannot_run_is_one_message(sysid, lumped_file, tmp_path):
    remembers = tmp_path / "remembers.json"
    kind = effect_kind("seating_leakage")
    write_card(card_with(kind(**kind.facts.nominal)), remembers)
    said = sysid("isolator", remembers, "-o", tmp_path / "out")
    assert said.code == 1
    assert "cannot run effect 'seating_leakage' (the force depends on what came before" in said.err
    assert "Supported: gas_spring" in said.err
    assert not (tmp_path / "out").exists()
    said = sysid("isolator", lumped_file, "-o", tmp_path / "out", "--duration", "never")
    assert said.code == 2
    assert sysid("isolator", lumped_file, "-o", tmp_path / "out", "--controller", "LQR").code == 2
    assert sysid("isolator", tmp_path / "none.json", "-o", tmp_path / "out").code == 1


def test_files_of_an_earlier_run_are_told_and_left_alone(sysid, card_file, tmp_path):
    """W11's model has no laws of temperature, and a quarter car no rig: neither is written."""
    out = tmp_path / "out"
    out.mkdir()
    for name in ("laws.png", "rig.png", "conflict.png", "card.json", "my.png"):
        (out / name).write_text("before")
    order = ["--plant", "quarter-car", *QUICK, "--draws", "0"]
    said = sysid("isolator", card_file, "-o", out, *order)
    assert said.code in (0, 3), said.err
    assert f"Note: laws.png, rig.png in {out} are of an earlier run" in said.err
    assert (out / "laws.png").read_text() == "before"
    assert (out / "conflict.png").read_bytes() != b"before"
