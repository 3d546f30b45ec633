"""`sysid fit --model lumped` on sweeps over temperature, as a user runs it."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from sysid.cards import read_card
from sysid.cards.models import damper_of
from sysid.cli.app import run
from sysid.cli.left_behind import left_behind
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from sysid.rig.truth import Truth, open_seal
from tests.structure.result_keys import missing, written

DATASETS = Path(__file__).parents[2] / "datasets"
SWEEP = DATASETS / "virtual-bs09"
EXCITATIONS = ("10mm_8Hz", "5mm_4Hz")
CURRENTS = ("0", "0.4", "1")


def part_of(folder: Path, temperatures: tuple[int, ...]) -> Path:
    """Some of the shipped sweep's tests."""
    folder.mkdir()
    shutil.copy(SWEEP / "campaign.toml", folder)
    for excitation in EXCITATIONS:
        for current in CURRENTS:
            for t in temperatures:
                shutil.copy(SWEEP / f"{excitation}_{current}A_{t}C.csv", folder)
    return folder


def fit(folder: Path, out: Path) -> int:
    return run(["fit", str(folder), "--model", "lumped", "-o", str(out), "--no-posterior"])


@pytest.fixture(scope="module")
def truth() -> Truth:
    return open_seal(SWEEP / "sealed" / "truth.json")


@pytest.fixture(scope="module")
def swept(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("swept")
    assert fit(part_of(out / "tests", (15, 35, 55, 75)), out / "fit") == 0
    return out / "fit"


@pytest.fixture(scope="module")
def told(swept) -> dict:
    return json.loads((swept / "fit.json").read_text())


def test_every_key_stands_on_the_page_of_keys(told):
    assert {"static_force", "straight_lines", "temperature_laws"} <= set(told)
    assert missing(written(told), "fit.json") == []


def test_table_1_lies_in_the_intervals(swept, truth):
    free = [p for p in read_card(swept / "card.json").parameters if p.sd > 0.0]
    assert len(free) == 14
    inside = [p.low <= truth.parameters[p.symbol] <= p.high for p in free]
    assert sum(inside) >= 12
    by_symbol = {p.symbol: p for p in free}
    assert by_symbol["C_post[0 A].intercept"].sd < 0.02 * 1400.0
    assert by_symbol["k.slope"].sd < 0.04 * 150e3


def test_the_card_gives_errors_and_forces_again(swept, told, sysid, tmp_path):
    card = swept / "card.json"
    checked = sysid("validate", card, swept.parent / "tests", "--json")
    assert checked.code == 0, checked.err
    errors = {t["id"]: t["nrmse"] for t in told["tests"]}
    assert {t["id"]: t["nrmse"] for t in checked.json["tests"]} == pytest.approx(errors, rel=1e-9)
    sine = ["--amplitude", "5mm", "--frequency", "4Hz", "--current", "0.4A", "--temperature", "40C"]
    said = sysid("simulate", card, *sine, "-o", tmp_path / "force.csv", "--json")
    assert said.code == 0, said.err
    force = np.asarray(simulate(damper_of(read_card(card)), sine_motion(0.005, 4.0, 0.4, 40.0)))
    assert said.json["force_max_N"] == pytest.approx(force.max(), rel=1e-9)


def test_the_gas_is_told_beside_the_model(swept, told, truth):
    statics = told["static_force"]
    line = statics["line"]
    at_20 = line["intercept"]["value"] + 20.0 * line["slope"]["value"]
    assert at_20 == pytest.approx(truth.parameters["gas_force"], abs=5.0)
    assert line["slope"]["low"] > 0.0
    assert set(statics["tests"]) == {t["id"] for t in told["tests"]}
    mean = told["summary"]["mean_nrmse"]
    assert statics["mean_nrmse_without"] < 0.015 < 0.05 < mean
    assert any("static force" in z for z in read_card(swept / "card.json").known_discrepancies)


def test_recipes_are_told_with_their_bias_and_drawn(swept, told):
    assert (swept / "straight_lines.png").read_bytes()[:4] == b"\x89PNG"
    assert "straight_lines.png" in left_behind(swept, ()), "a later run knows it"
    lines = told["straight_lines"]["lines"]
    assert [(z["symbol"], z["current_A"]) for z in lines] == [
        *((symbol, i) for symbol in ("C_post", "F_y") for i in (0.0, 0.4, 1.0)),
        ("k", 1.0),
    ]
    card = read_card(swept / "card.json").values()
    for line in lines:
        assert line["bias"]["low"] <= line["bias"]["mean"] <= line["bias"]["high"]
        symbol, at = line["symbol"], f"[{line['current_A']:g} A]"
        name = symbol if symbol == "k" else symbol + at
        read, fitted = (
            np.array([a + b * t for t in (15.0, 75.0)])
            for a, b in (
                (line["intercept"]["value"], line["slope"]["value"]),
                (card[f"{name}.intercept"], card[f"{name}.slope"]),
            )
        )
        bias = np.mean(read / fitted) - 1.0
        assert bias == pytest.approx(line["bias"]["mean"], abs=0.04)
    by_symbol = {(z["symbol"], z["current_A"]): z["bias"] for z in lines}
    assert 0.01 < by_symbol["C_post", 1.0]["low"] < by_symbol["C_post", 1.0]["high"] < 0.08
    assert by_symbol["F_y", 0.0]["high"] < -0.1


def test_straight_lines_stay_straight(told):
    laws = told["temperature_laws"]
    assert laws["blocks"] == 8
    assert [z["symbol"] for z in laws["bent"]] == ["C_post", "F_y", "k"]
    assert not any(z["curved"] for z in laws["bent"])
