"""Cards that must be refused, each with file, place and reason."""

import json
from typing import Any

import pytest

from sysid.cards import read_card
from sysid.errors import CardError


def put(path: str, value: Any):
    """Set one value at a JSON path like ``parameters.0.value``."""

    def change(raw: dict[str, Any]) -> None:
        *above, last = (int(p) if p.isdigit() else p for p in path.split("|"))
        place: Any = raw
        for key in above:
            place = place[key]
        place[last] = value

    return change


def drop(key: str):
    return lambda raw: raw.pop(key)


def double(raw: dict[str, Any]) -> None:
    raw["parameters"].append(raw["parameters"][0])


def lose(raw: dict[str, Any]) -> None:
    raw["parameters"] = [p for p in raw["parameters"] if p["symbol"] != "k_4"]


EFFECT = {"id": "gas_sprong", "stage": "force", "parameters": []}

BAD = {
    "no version": (drop("schema"), r": is no model card: the key 'schema' is missing"),
    "other format": (put("schema", "sysid-fit-1"), r", schema: schema 'sysid-fit-1' is not that"),
    "version zero": (put("schema", "sysid-card-0"), r", schema: .*not that of a model card"),
    "version no text": (put("schema", 1), r", schema: schema '1' is not"),
    "unknown key": (put("colour", "red"), r", colour: this key is not known"),
    "unknown inner key": (put("parameters|0|note", 1), r", parameters\[0\]\.note: this key is not"),
    "missing key": (drop("quality"), r", quality: this key is missing"),
    "a check that checks nothing": (put("check|0|tolerance", 10.0), r", check\[0\]\.tolerance"),
    "a box without motion": (
        put("validity|amplitude_m", [0.0, 0.0]), r", validity: amplitude_m: 0 to 0 holds no motion",
    ),
    "a box of no speed": (put("validity|velocity_m/s", [0.0, 0.0]), r", validity: .*no motion"),
    "time that stands still": (put("check|0|time_s|3", 0.0), r", check\[0\]: .*does not increase"),
    "text for a number": (
        put("parameters|0|value", "70"), r", parameters\[0\]\.value: \"70\" is refused",
    ),
    "truth for a number": (
        put("parameters|0|value", True), r", parameters\[0\]\.value: true is refused",
    ),
    "negative F_0": (
        put("parameters|0|value", -70.0), r", parameters\[0\]\.value: F_0 = -70 N is outside",
    ),
    "other unit": (
        put("parameters|0|unit", "kN"), r", parameters\[0\]\.unit: the unit of F_0 is N, not kN",
    ),
    "unknown symbol": (
        put("parameters|3|symbol", "c_0"), r", parameters\[3\]\.symbol: model .* no parameter 'c_",
    ),
    "symbol twice": (double, r": parameter F_0 stands there twice"),
    "symbol missing": (lose, r", parameters: model 'generalized' lacks parameter k_4"),
    "unknown model": (put("model", "maxwell"), r", model: model 'maxwell' is not known"),
    "unknown effect": (put("effects", [EFFECT]), r", effects\[0\]\.id: effect 'gas_sprong'"),
    "unknown weights": (put("weights", "best"), r", weights: \"best\" is refused"),
    "negative sd": (put("parameters|0|sd", -1.0), r", parameters\[0\]\.sd: -1\.0 is refused"),
    "interval turned": (
        lambda raw: raw["parameters"][0].update(low=2.0, high=1.0),
        r", parameters\[0\]: low = 2 is above high = 1",
    ),
    "not symmetric": (put("covariance|matrix|0|1", 0.9), r", covariance: not symmetric at \(I_0"),
    "not square": (put("covariance|matrix|0", [1.0]), r", covariance: the matrix is 3 × 3, 3 sym"),
    "too small": (put("covariance|matrix", [[1.0]]), r", covariance: the matrix is 1 × 1"),
    "negative variance": (put("covariance|matrix|0|0", -1.0), r", covariance: the variance of F_0"),
    "foreign covariance": (
        put("covariance|symbols|0", "z"), r": covariance names z, which is no parameter",
    ),
    "box turned": (put("validity|current_A", [0.4, 0.0]), r", validity: current_A: 0\.4 is above"),
    "box of one": (put("validity|current_A", [0.4]), r", validity\.current_A\[1\]: this key"),
    "no hash": (put("data|0|sha256", "abc"), r", data\[0\]\.sha256: \"abc\" is refused"),
    "no check": (put("check", []), r", check: \[\] is refused"),
    "uneven check": (put("check|0|force_N", [1.0]), r", check\[0\]: force_N has 1 entries"),
    "zero tolerance": (put("check|0|tolerance", 0.0), r", check\[0\]\.tolerance: 0\.0 is refused"),
    "altered parameter": (
        put("parameters|0|value", 68.507), r", check\[0\]\.force_N\[\d+\]: does not reproduce",
    ),
    "altered force": (
        put("check|2|force_N|5", 1000.0), r", check\[2\]\.force_N\[5\]: does not reproduce",
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", BAD)
def test_wrong_content_is_refused_with_file_and_place(kind, raw, tmp_path):
    change, message = BAD[kind]
    change(raw)
    path = tmp_path / "card.json"
    path.write_text(json.dumps(raw))
    with pytest.raises(CardError, match=r"card\.json" + message):
        read_card(path)


BROKEN = {
    "empty": (b"", r"card\.json, line 1, column 1: is not valid JSON"),
    "cut off": (b'{"schema": "sysid-card-1", "mod', r"line 1, column 28: is not valid JSON"),
    "a list": (b"[1, 2]", r"outermost JSON value is not an object"),
    "not UTF-8": (b'{"schema": "\xff"}', r"is not UTF-8 text"),
    "NaN": (b'{"schema": "sysid-card-1", "x": NaN}', r"NaN stands where a number must"),
    "key twice": (b'{"schema": "a", "schema": "b"}', r"key 'schema' stands twice"),
    "too deep": (b"[" * 100_000, r"no readable JSON|not valid JSON"),
    "endless number": (b'{"schema": ' + b"9" * 5000 + b"}", r"no readable JSON"),
    "infinite": (b'{"schema": "sysid-card-1", "software": 1e999}', r"software"),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_broken_files_are_refused(kind, tmp_path):
    content, message = BROKEN[kind]
    path = tmp_path / "card.json"
    path.write_bytes(content)
    with pytest.raises(CardError, match=message) as caught:
        read_card(path)
    assert "card.json" in str(caught.value)


def test_a_folder_and_a_missing_file_are_refused(tmp_path):
    for path in (tmp_path, tmp_path / "nothing.json"):
        with pytest.raises(CardError, match="the card cannot be read"):
            read_card(path)


def test_infinite_numbers_in_the_card_are_refused(raw, tmp_path):
    text = json.dumps(raw).replace("0.393", "1e999")
    (tmp_path / "card.json").write_text(text)
    with pytest.raises(CardError, match=r"validity\.velocity_m/s\[1\]: .*finite"):
        read_card(tmp_path / "card.json")
