"""Tare and free rod: their mean force is told, and stays where it is."""

import json

import numpy as np
import pytest

from sysid.cards import read_card
from sysid.report.diagnosis_json import diagnosis_json
from tests.report.made_diagnosis import backlash

ZERO, MASS, FREQUENCY = 50.0, 1.7, 3.0
TIME = np.arange(0.0, 3.0, 0.002)


def write(path, displacement_mm, force):
    rows = "\n".join(
        f"{t:.4f},{x:.6f},{f:.4f},0" for t, x, f in zip(TIME, displacement_mm, force, strict=True)
    )
    path.write_text(f"time_s,displacement_mm,force_N,current_A\n{rows}\n", encoding="utf-8")


@pytest.fixture
def zeroed(make_campaign):
    """Three tests, a tare and a run with the rod disconnected, with a zero of the load cell."""
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5), (5.0, 2.0, 0.0)])
    listed = [f"{path.name},sine" for path in sorted(folder.glob("*.csv"))]
    wave = np.sin(2.0 * np.pi * FREQUENCY * TIME)
    acceleration = -((2.0 * np.pi * FREQUENCY) ** 2) * 0.01 * wave
    write(folder / "zero.csv", 1e-3 * np.sign(wave), np.full(TIME.size, ZERO))
    write(folder / "free.csv", 10.0 * wave, ZERO + MASS * acceleration)
    listed += ["zero.csv,tare", "free.csv,rod_disconnected"]
    (folder / "tests.csv").write_text("file,kind\n" + "\n".join(listed) + "\n", encoding="utf-8")
    return folder


def test_check_tells_the_mean_force_and_that_it_stays(sysid, zeroed):
    said = sysid("check", zeroed, "--json")
    (told,) = [note for note in said.json["notes"] if "Without the damper" in note]
    assert "50 N in zero (tare)" in told
    assert "50 N in free (rod_disconnected; force over acceleration 1.7 kg)" in told
    assert "Nothing of it was subtracted" in told
    assert "subtract it from the forces in the files" in told
    assert f"Note: {told}" in said.err
    before = {t["id"]: t["descriptors"] for t in said.json["tests"]}
    for name in ("zero.csv", "free.csv", "tests.csv"):
        (zeroed / name).unlink()
    bare = sysid("check", zeroed, "--json")
    assert not any("Without the damper" in note for note in bare.json["notes"])
    for test in bare.json["tests"]:
        assert before[test["id"]] == test["descriptors"]


def test_a_fit_tells_it_in_its_files(sysid, zeroed, tmp_path):
    out = tmp_path / "out"
    order = ("fit", zeroed, "--model", "tanh", "-o", out)
    said = sysid(*order)
    assert "Note: Without the damper the mean force is 50 N in free" in said.err
    for told in (
        json.loads((out / "fit.json").read_text())["notes"],
        read_card(out / "card.json").known_discrepancies,
    ):
        assert any("50 N in zero (tare)" in sentence for sentence in told)
    assert "50 N in zero (tare)" in (out / "report.html").read_text(encoding="utf-8")
    without = sysid(*order, "--exclude", "zero", "--exclude", "free")
    assert "Without the damper" not in without.err


def test_a_diagnosis_tells_it(sysid, zeroed, tmp_path):
    said = sysid("diagnose", zeroed, "--holdout", "*mm*", "-o", tmp_path / "out")
    assert said.code == 1, "nothing is left to diagnose, and all notes are told before"
    assert "Note: Without the damper the mean force is 50 N in free" in said.err
    assert diagnosis_json(backlash(), notes=["a zero"])["notes"][-1] == "a zero"
