"""A card written, read, recomputed, and published as JSON Schema."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import sysid.cards
from sysid.cards import read_card, write_card
from sysid.cards.check import recompute
from sysid.cards.migrate import migrate
from sysid.cards.models import MODELS, damper_of
from sysid.cards.schema import json_schema
from sysid.cards.write import card_text, json_text
from sysid.data.whole_file import write_files
from sysid.errors import CardError, OutputError
from sysid.identification.families import FAMILIES
from sysid.models.generalized import LOW_SYMMETRIC
from sysid.parameters import as_dict

PUBLISHED = Path(sysid.cards.__file__).with_name("card-1.schema.json")


def test_reads_back_what_was_written_to_the_last_digit(card, tmp_path):
    path = tmp_path / "Dämpfer 阻尼器 1" / "card one.json"
    path.parent.mkdir()
    write_card(card, path)
    again = read_card(path)
    assert again == card
    assert card_text(again) == path.read_text(encoding="utf-8")
    assert as_dict(damper_of(again).valve) == LOW_SYMMETRIC


def test_check_vectors_come_out_and_cover_the_box(card, tmp_path):
    write_card(card, tmp_path / "card.json")
    read = read_card(tmp_path / "card.json")
    damper = damper_of(read)
    for check in read.check:
        force = np.array(check.force)
        error = np.abs(recompute(damper, check) - force).max()
        assert error <= 1e-9 * np.abs(force).max()
        assert max(np.abs(check.displacement)) <= card.validity.amplitude[1]
        assert max(np.abs(check.velocity)) <= card.validity.velocity[1]
    currents = {i for check in read.check for i in check.current}
    assert {0.0, 0.2, 0.4} <= currents
    assert len({check.current for check in read.check}) == len(read.check)


def test_check_vectors_on_a_sine_are_the_loop_of_the_model(card):
    """On a sinusoid Eq. 10 gives v_m = Aω exactly, so the first vectors are W11's loops."""
    from sysid.models.simulate import simulate
    from sysid.motion.motion import sine_motion

    check = card.check[1]
    amplitude, speed = 0.0125, 0.8 * 0.393
    frequency = speed / amplitude / (2 * np.pi)
    a, f, i = (np.array([z]) for z in (amplitude, frequency, 0.2))
    loop = simulate(damper_of(card), sine_motion(a, f, i, points=128))
    np.testing.assert_allclose(check.force, np.asarray(loop)[0, 1::4], rtol=1e-9)


def test_published_schema_is_the_one_of_the_code_and_accepts_the_card(card, raw):
    published = json.loads(PUBLISHED.read_text())
    assert published == json_schema()
    assert PUBLISHED.read_text() == json_text(json_schema())
    jsonschema.Draft202012Validator.check_schema(published)
    validator = jsonschema.Draft202012Validator(published)
    assert list(validator.iter_errors(raw)) == []
    raw["validity"]["amplitude_m"] = "12.5 mm"
    raw["remark"] = "unknown"
    assert len(list(validator.iter_errors(raw))) == 2


def test_keys_are_those_of_the_contract(raw):
    assert list(raw) == [
        "schema", "software", "model", "variant", "weights", "damper", "parameters", "effects",
        "covariance", "posterior", "interval", "validity", "quality", "known_discrepancies",
        "data", "check",
    ]  # fmt: skip
    assert list(raw["validity"]) == [
        "amplitude_m", "frequency_Hz", "velocity_m/s", "current_A", "temperature_degC", "centre_m",
    ]  # fmt: skip
    assert list(raw["check"][0]) == [
        "time_s", "displacement_m", "velocity_m/s", "acceleration_m/s2", "current_A",
        "temperature_degC", "force_N", "tolerance",
    ]  # fmt: skip


def test_every_model_that_can_be_fitted_can_be_read():
    assert {f.name: f.valve for f in FAMILIES} == dict(MODELS)


def test_text_in_brackets_is_left_alone_and_numbers_stand_on_one_line(card):
    text = card_text(card)
    assert '"The list [ 1, 2 ] stays as it is."' in text
    assert '"amplitude_m": [0.0125, 0.0125],' in text
    value = {"a": ["[\n 1\n]", [1, 2.5e-9], []], "b": "é"}
    assert json.loads(json_text(value)) == value


def test_reading_without_check_needs_neither_jax_nor_scipy(card, tmp_path):
    write_card(card, tmp_path / "card.json")
    program = (
        "import sys; from pathlib import Path; from sysid.cards import read_card\n"
        f"print(read_card(Path({str(tmp_path / 'card.json')!r}), check=False).model)\n"
        "print(sorted({'jax', 'scipy', 'pandas', 'equinox', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == ["generalized", "[]"]


def _spoil(card, tmp_path, monkeypatch, name, error):
    path = tmp_path / "card.json"
    path.write_text("old")

    def fail(*args, **kwargs):
        raise OSError(error, os.strerror(error))

    monkeypatch.setattr(os, name, fail)
    with pytest.raises(OutputError) as caught:
        write_card(card, path)
    monkeypatch.undo()
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["card.json"]
    return str(caught.value)


def test_full_disk_leaves_the_old_card_and_nothing_else(card, tmp_path, monkeypatch):
    text = _spoil(card, tmp_path, monkeypatch, "fsync", errno.ENOSPC)
    assert "no space left on device" in text
    assert "card.json" in text


def test_no_permission_leaves_the_old_card(card, tmp_path, monkeypatch):
    assert "permission denied" in _spoil(card, tmp_path, monkeypatch, "replace", errno.EACCES)


def test_folder_that_is_missing(card, tmp_path):
    with pytest.raises(OutputError, match="cannot be written: no such file"):
        write_card(card, tmp_path / "nowhere" / "card.json")


def test_older_versions_are_migrated_step_by_step(raw):
    """Version 1 is the first; the hook is tested with two invented ones."""
    seen = []

    def step(old):
        seen.append(old["schema"])
        return {**old, "new": len(seen)}

    done = migrate(raw, where="x", migrations={1: step, 2: step}, current=3)
    assert seen == ["sysid-card-1", "sysid-card-2"]
    assert (done["schema"], done["new"]) == ("sysid-card-3", 2)
    assert raw["schema"] == "sysid-card-1"
    assert "new" not in raw
    assert migrate(raw, where="x") == raw


def test_newer_version_is_refused_with_advice(raw, tmp_path):
    raw["schema"] = "sysid-card-2"
    raw["key of the future"] = 1
    (tmp_path / "card.json").write_text(json.dumps(raw))
    with pytest.raises(CardError, match=r"card\.json, schema: is a card of version 2.* Update"):
        read_card(tmp_path / "card.json")


def test_nothing_is_written_where_a_folder_is_in_the_way(tmp_path):
    (tmp_path / "b.txt").mkdir()
    with pytest.raises(OutputError, match=r"b\.txt: cannot be written: is a directory"):
        write_files({"a.txt": b"1", "b.txt": b"2"}, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["b.txt"]
