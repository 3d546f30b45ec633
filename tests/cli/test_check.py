"""`sysid check` as a user runs it."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sysid.cli.app import run
from sysid.cli.console import Talk
from sysid.data.quality import KINDS
from tests.structure.result_keys import missing, written

HIGH = Path(__file__).parents[2] / "datasets" / "virtual-w11-high"


def test_shipped_data_are_sound(sysid, tmp_path):
    said = sysid("check", HIGH, "--json", "-o", tmp_path / "out")
    assert said.code == 0
    result = said.json
    assert result["trustworthy"]
    assert len(result["tests"]) == 25
    assert result["missing"] == []
    test = next(t for t in result["tests"] if t["id"] == "2.5mm_10Hz_0.2A")
    assert test["amplitude_m"] == pytest.approx(2.5e-3, rel=0.02)
    assert test["frequency_Hz"] == pytest.approx(10.0, rel=0.01)
    assert test["current_A"] == pytest.approx(0.2, abs=0.01)
    assert test["descriptors"]["peak_compression_N"] == pytest.approx(1196, rel=0.03)
    assert test["noise_floor_N"] > 0
    assert test["cycles"] >= 3
    assert {f["kind"] for t in result["tests"] for f in t["faults"]} <= set(KINDS)
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"check.json", "loops.png"}
    assert json.loads((tmp_path / "out" / "check.json").read_text()) == result
    assert missing(written(result), "sysid check") == []


def test_tables_for_people(sysid):
    said = sysid("check", HIGH)
    assert said.code == 0
    for words in ("amplitude / mm", "repeatability / N", "2.5mm_15Hz_0.4A", "C_eq", "0.4 A"):
        assert words in said.out


def test_missing_combinations_are_named(sysid, make_campaign):
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5), (5.0, 2.0, 0.0)])
    said = sysid("check", folder, "--json")
    (missing,) = said.json["missing"]
    assert missing["amplitude_m"] == pytest.approx(0.005, rel=0.01)
    assert missing["current_A"] == 0.5
    assert missing["temperature_degC"] is None
    assert "–" in sysid("check", folder).out


def test_a_current_that_is_not_known_is_one_column_and_is_asked_for(sysid, make_campaign):
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5), (5.0, 2.0, 0.0)])
    for k, path in enumerate(sorted(folder.glob("*.csv"))):
        path.rename(path.with_name(path.stem.rpartition("_")[0] + f"_r{k}.csv"))
    said = sysid("check", folder)
    assert said.out.count("? A") == 1
    assert "the current of 3 of 3 tests is not known" in said.out
    assert "a fit needs it" in said.out
    assert "a fit needs it" not in sysid("check", HIGH).out


def test_temperatures_stand_beside_the_rows_or_as_a_range_in_the_title(sysid, make_campaign):
    tests = [(10.0, 2.0, i) for i in (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)]
    folder = make_campaign(tests)
    paths = sorted(folder.glob("*.csv"))
    whole = [path.read_text() for path in paths]
    for degrees, words in (
        ((20, 20, 20, 60, 60, 60), ("T / °C", "60")),
        ((20, 23, 26, 29, 32, 35), ("20–35 °C",)),
    ):
        for path, text, degree in zip(paths, whole, degrees, strict=True):
            head, *rows = text.split()
            warm = [f"{head},temperature_degC", *(f"{row},{degree}" for row in rows)]
            path.write_text("\n".join(warm))
        said = sysid("check", folder)
        assert said.code == 0
        table = said.out.partition("number of tests")[0]
        assert all(word in table for word in words), table


def test_faults_are_told_with_evidence(sysid, make_campaign):
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5), (5.0, 2.0, 0.0)])
    path = folder / "10mm_2Hz_0.5A.csv"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    table[:, 2] = np.clip(table[:, 2], -300.0, 300.0)
    np.savetxt(path, table, delimiter=",", header="time_s,displacement_mm,force_N", comments="")
    said = sysid("check", folder)
    assert "10mm_2Hz_0.5A: clipping: " in said.out
    faults = {t["id"]: t["faults"] for t in sysid("check", folder, "--json").json["tests"]}
    assert "clipping" in {f["kind"] for f in faults["10mm_2Hz_0.5A"]}
    assert "clipping" not in {f["kind"] for f in faults["10mm_2Hz_0A"]}


@pytest.mark.parametrize(
    ("scale", "heads"), [(1.0, ("i / A", "0 A", "0.5 A")), (0.1, ("i / mA", "0 mA", "50 mA"))]
)
def test_currents_are_shown_as_engineers_write_them(sysid, make_campaign, scale, heads):
    """A supply leaves microamperes: they are no 3.02e-06 A."""
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5)])
    for path in folder.glob("*.csv"):
        current = scale * float(path.stem.rsplit("_", 1)[1].removesuffix("A")) + 3.02e-6
        head, *rows = path.read_text().split()
        path.write_text("\n".join([f"{head},current_A", *(f"{row},{current!r}" for row in rows)]))
    said = sysid("check", folder)
    assert said.code == 0
    for words in heads:
        assert words in said.out
    assert not re.search(r"\de[-+]\d", said.out + said.err)


def test_a_folder_without_tests(sysid, tmp_path):
    said = sysid("check", tmp_path)
    assert (said.code, said.out) == (1, "")
    assert str(tmp_path) in said.err


def test_utfsm_drop_outs_are_flagged_and_left_out(sysid, utfsm_folder, utfsm_manifest):
    said = sysid("check", utfsm_folder, "--manifest", utfsm_manifest, "--json")
    assert said.code == 0
    unfit = {t["id"] for t in said.json["tests"] if t["unfit"]}
    assert unfit == {"25mm0x25Hz_0x75A", "25mm0x25Hz_1A"}


def test_peak_forces_are_held_against_the_drawing(sysid, make_campaign):
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5), (5.0, 2.0, 0.0)])
    bare = sysid("check", folder, "--json").json
    assert bare["tolerance"] is None
    read = {t["id"]: t["descriptors"] for t in bare["tests"]}
    peak = read["10mm_2Hz_0A"]["peak_compression_N"] - read["10mm_2Hz_0A"]["reversal_force_N"]
    manifest = folder / "campaign.toml"
    text = manifest.read_text(encoding="utf-8") if manifest.exists() else ""
    points = [
        f"{{ velocity = 0.125, current = 0, compression = [{0.9 * peak}, {1.1 * peak}] }},",
        f"{{ velocity = 0.125, current = 0.5, compression = [{0.1 * peak}, {0.2 * peak}] }},",
        f"{{ velocity = 0.9, rebound = {{ nominal = {peak}, percent = 10 }} }},",
    ]
    manifest.write_text(
        f"{text}\n[tolerance]\npoints = [\n" + "\n".join(points) + "\n]\n", encoding="utf-8"
    )
    found = sysid("check", folder, "--json").json["tolerance"]
    assert {t["id"]: (t["line"], t["verdict"]) for t in found["tests"]} == {
        "10mm_2Hz_0A": (1, "inside"), "10mm_2Hz_0.5A": (2, "outside"),
    }  # fmt: skip
    assert found["lines_untested"] == [3]
    said = sysid("check", folder)
    assert said.code == 0
    for words in (found["sentence"], "✓ inside", "✗ compression", "above"):
        assert words in said.out

    manifest.write_text(manifest.read_text(encoding="utf-8").replace("0.9,", "-0.9,"))
    said = sysid("check", folder)
    assert said.code == 1
    assert "peak velocity must be positive" in said.err


def test_the_temperature_of_the_drawing_is_named_where_it_decides(sysid, make_campaign):
    folder = make_campaign([(10.0, 2.0, 0.0)])
    bare = (folder / "campaign.toml").read_text() if (folder / "campaign.toml").exists() else ""
    drawing = (
        "[tolerance]\ntemperature = [18, 22]\n"
        "points = [{ velocity = 0.125, current = 0, compression = { lowest = 1 } }]\n"
    )
    (folder / "campaign.toml").write_text(f"{bare}\n{drawing}", encoding="utf-8")
    unknown = sysid("check", folder)
    assert "? temperature not known; if it is 18 to 22 °C: inside" in unknown.out
    assert "✓" not in unknown.out
    assert "1 is open: the drawing holds at 18 to 22 °C" in unknown.out
    warm = '[constants]\ntemperature = { value = 39, unit = "degC" }\n'
    (folder / "campaign.toml").write_text(f"{bare}\n{warm}{drawing}", encoding="utf-8")
    found = sysid("check", folder, "--json").json["tolerance"]
    assert found["tests"] == []
    assert missing({"tolerance": set(found)}, "sysid check") == []
    assert found["not_judged"] == [{"id": "10mm_2Hz_0A", "line": 1, "temperature_degC": 39.0}]
    assert "at 39 °C, and the drawing holds at 18 to 22 °C only" in found["sentence"]
    assert "No test has" not in found["sentence"]


def test_names_are_told_and_drawn_as_they_are(sysid, make_campaign, tmp_path):
    """Brackets are no markup, dollars no formula."""
    folder = make_campaign(name="rig$1_$2 [up]")
    for path in folder.glob("*_0A.csv"):
        path.rename(path.with_name("10mm_2Hz_0A_[front].csv"))
    said = sysid("check", folder, "-o", tmp_path / "out")
    assert said.code == 0, said.err
    assert said.out.count("10mm_2Hz_0A_[front]") >= 1
    assert "rig$1_$2 [up]: tests as measured" in said.out
    assert (tmp_path / "out").is_dir()


def test_results_are_on_the_disk_before_anything_is_printed(make_campaign, tmp_path, monkeypatch):
    def gone(*_):
        raise BrokenPipeError

    monkeypatch.setattr(Talk, "show", gone)
    folder = make_campaign()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sysid.cli.app._discard_stdout", lambda: None)
        assert run(["check", str(folder), "-o", str(tmp_path / "out")]) == 1
    assert any((tmp_path / "out").iterdir())


def test_a_terminal_that_lacks_a_sign_gets_another_one(make_campaign):
    folder = make_campaign()
    program = [sys.executable, "-c", "from sysid.cli.app import main; main()", "check", folder]
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(program, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert b"internal fault" not in done.stderr


def test_a_test_without_a_loop_is_told(sysid, make_campaign):
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5), (5.0, 2.0, 0.0)])
    path = folder / "10mm_2Hz_0.5A.csv"
    rows = path.read_text().splitlines()
    ramp = [f"{row},{k / len(rows):.6f}" for k, row in enumerate(rows[1:])]
    path.write_text("\n".join([rows[0] + ",current_A", *ramp]) + "\n")
    said = sysid("check", folder)
    assert "10mm_2Hz_0.5A: the current changes between" in said.out
    assert "left out of fits" in said.out
    (test,) = [t for t in sysid("check", folder, "--json").json["tests"] if t["unfit"]]
    assert test["id"] == "10mm_2Hz_0.5A"
