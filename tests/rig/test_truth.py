"""Sealing and opening the truth."""

import json

import pytest

from sysid.errors import DataError
from sysid.rig.truth import Truth, open_seal, seal

TRUTH = Truth(
    scenario="example",
    seed=3,
    model="W11 Eqs. 3-10",
    parameters={"F_0": 68.506},
    effects=({"id": "gas_spring", "k_g": 1850.0},),
    tests={"12.5mm_1.5Hz_0.2A": {"gain": 0.0061, "delay": -0.000123456789012345}},
)


def test_a_sealed_truth_opens_to_the_same_numbers(tmp_path):
    text, digest = seal(TRUTH)
    path = tmp_path / "truth.json"
    path.write_text(text)
    assert open_seal(path) == TRUTH
    assert json.loads(text)["sha256"] == digest


def test_nothing_of_the_truth_can_be_read_in_passing():
    text, _ = seal(TRUTH)
    for word in ("F_0", "68.5", "gas_spring", "1850", "gain", "0.0061"):
        assert word not in text


def test_a_truth_that_was_changed_is_refused(tmp_path):
    text, _ = seal(TRUTH)
    other, _ = seal(Truth("example", 4, TRUTH.model, TRUTH.parameters, (), {}))
    forged = json.loads(other) | {"sha256": json.loads(text)["sha256"]}
    path = tmp_path / "truth.json"
    path.write_text(json.dumps(forged))
    with pytest.raises(DataError, match=r"truth\.json: the truth was changed after it was sealed"):
        open_seal(path)


@pytest.mark.parametrize(
    "text",
    ["", "[]", "no json", '{"schema": 1}', '{"schema":"x","sha256":"","sealed":["%"]}', "é"],
)
def test_what_is_no_seal_is_refused_with_its_name(tmp_path, text):
    path = tmp_path / "truth.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DataError, match=r"truth\.json: is no sealed truth"):
        open_seal(path)


def test_a_newer_seal_and_a_missing_one_are_refused(tmp_path):
    path = tmp_path / "truth.json"
    with pytest.raises(DataError, match="cannot be read"):
        open_seal(path)
    text, _ = seal(TRUTH)
    path.write_text(text.replace("sysid-sealed-truth-1", "sysid-sealed-truth-2"))
    with pytest.raises(DataError, match="sysid-sealed-truth-2"):
        open_seal(path)
