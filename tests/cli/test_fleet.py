"""`sysid fit --each`: a fleet, its table, and what is done again."""

import csv
import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from sysid.cli import fleet as module
from sysid.cli import identify as pipeline

LOW = Path(__file__).parents[2] / "datasets" / "virtual-w11-low"
ONE = ("--each", "--workers", "1", "--variant", "passive", "--quiet")
LOUD = ONE[:-1]


def damper(folder: Path, frequencies=("0.5", "1.5"), currents=("0",)) -> Path:
    """Tests of one damper, copied from the shipped campaign."""
    folder.mkdir(parents=True)
    for f in frequencies:
        for i in currents:
            shutil.copy(LOW / f"12.5mm_{f}Hz_{i}A.csv", folder)
    return folder


@pytest.fixture
def fleet(tmp_path) -> Path:
    """Two sound dampers, one whose files are empty, a folder of notes."""
    damper(tmp_path / "fleet" / "a")
    damper(tmp_path / "fleet" / "b", ("1.5", "2.5"))
    broken = damper(tmp_path / "fleet" / "broken")
    for path in broken.glob("*.csv"):
        path.write_text("")
    (tmp_path / "fleet" / "notes").mkdir()
    return tmp_path / "fleet"


@pytest.fixture
def fitted(monkeypatch):
    """Which campaigns were fitted; the fit itself is replaced by a card that is there."""
    names = []
    card = (LOW.parents[1] / "fits" / LOW.name / "card.json").read_bytes()

    def stand_in(campaign, selection, **options):
        names.append(campaign.name)
        tests = [{"id": name, "used": True} for name in selection.loops.ids]
        summary = {
            "result": "converged", "tests": tests, "summary": {"mean_nrmse": 0.01},
            "weights": options["weights"],
        }  # fmt: skip
        files = {"fit.json": json.dumps(summary).encode(), "card.json": card}
        distrust = ("it ran out of steps",) if campaign.name == "doubtful" else ()
        return pipeline.Identified(None, None, None, summary, files, distrust)  # type: ignore[arg-type]  # not read by the command

    monkeypatch.setattr(pipeline, "identify", stand_in)
    return names


def rows_of(out: Path) -> dict[str, dict[str, str]]:
    with (out / module.TABLE).open(newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def test_a_fleet_is_fitted_once_failures_are_listed_and_mended_ones_are_fitted(
    fleet, fitted, sysid, tmp_path
):
    out = tmp_path / "out"
    said = sysid("fit", fleet, *ONE, "-o", out)
    assert said.code == 1, "a damper failed"
    assert "broken could not be fitted" in said.err
    assert "2 dampers fitted (0 of them before), 1 failed" in said.out
    table = rows_of(out)
    assert set(table) == {"a", "b", "broken"}
    assert table["a"]["verdict"] == "sound"
    assert table["broken"]["verdict"].startswith("failed: ")
    card = json.loads((out / "a" / "card.json").read_text())
    for p in card["parameters"]:
        unit = f" [{p['unit']}]" if p["unit"] else ""
        assert float(table["a"][f"{p['symbol']}{unit}"]) == p["value"]
        assert float(table["a"][f"{p['symbol']} low{unit}"]) == p["low"]
        assert (p["symbol"] in table["a"]["not_determined"].split(", ")) == (not p["identified"])
    assert float(table["b"]["mean_nrmse"]) == 0.01
    assert fitted == ["a", "b"]

    shutil.rmtree(fleet / "broken")
    said = sysid("fit", fleet, *ONE, "-o", out)
    assert (said.code, fitted) == (0, ["a", "b"]), "nothing is fitted twice"

    shutil.copy(LOW / "12.5mm_2.5Hz_0A.csv", fleet / "a")
    (out / "b" / "card.json").unlink()
    assert sysid("fit", fleet, *ONE, "-o", out).code == 0
    assert fitted == ["a", "b", "a", "b"], "another file, and a result that is gone"
    assert rows_of(out)["a"]["tests"] == "3"

    assert sysid("fit", fleet, *ONE, "--weights", "peak", "-o", out).code == 0
    assert fitted[4:] == ["a", "b"], "another order"
    assert sysid("fit", fleet, *ONE, "-o", out).code == 0
    assert fitted[6:] == ["a", "b"], "the first one again, whose results the other replaced"
    for name in ("a", "b"):
        assert json.loads((out / name / "fit.json").read_text())["weights"] == "paper"
    (out / "a" / "card.json").write_text("{}")
    assert sysid("fit", fleet, *ONE, "-o", out).code == 0
    assert fitted[8:] == ["a"], "a result that somebody wrote over"


def test_results_of_an_earlier_run_are_told(fleet, fitted, sysid, tmp_path):
    """Of a damper that cannot be fitted any more, of one that has gone, of another order."""
    out = tmp_path / "out"
    shutil.rmtree(fleet / "broken")
    assert sysid("fit", fleet, *LOUD, "-o", out).code == 0
    (out / "a" / "card-2.json").write_text("{}")
    for path in (fleet / "b").glob("*.csv"):
        path.write_text("")
    shutil.copy(LOW / "12.5mm_2.5Hz_0A.csv", fleet / "a")
    (out / "gone").mkdir()
    (out / "gone" / "card.json").write_text("{}")
    said = sysid("fit", fleet, *LOUD, "-o", out)
    assert said.code == 1
    told = " ".join(said.err.split())
    assert f"a: card-2.json in {out / 'a'} is of an earlier run" in told
    assert f"card.json, fit.json in {out / 'b'} are of an earlier run" in told
    assert f"card.json in {out / 'gone'} is of an earlier run" in told


def test_a_line_without_its_cards_is_no_finished_damper(fleet, fitted, sysid, tmp_path):
    out = tmp_path / "out"
    shutil.rmtree(fleet / "broken")
    sysid("fit", fleet, *ONE, "-o", out)
    rows = [json.loads(line) for line in (out / module.ROWS).read_text().splitlines()]
    rows[0]["cards"] = None
    del rows[1]["cards"]
    (out / module.ROWS).write_text("".join(f"{json.dumps(row)}\n" for row in rows))
    assert sysid("fit", fleet, *ONE, "-o", out).code == 0
    assert fitted == ["a", "b", "a", "b"]


def test_a_doubtful_fit_is_exit_3_and_told_in_the_table(fleet, fitted, sysid, tmp_path):
    (fleet / "broken").rename(tmp_path / "broken")
    (fleet / "b").rename(fleet / "doubtful")
    said = sysid("fit", fleet, *ONE, "-o", tmp_path / "out", "--json")
    assert said.code == 3
    assert set(said.json["fits"]) == {"a/fit.json", "doubtful/fit.json"}
    assert rows_of(tmp_path / "out")["doubtful"]["verdict"] == "do not trust: it ran out of steps"
    assert "doubtful/card.json: it ran out of steps" in said.err


def test_workers_get_what_they_need_and_their_sentences_come_back(fleet, sysid, tmp_path):
    pytest.importorskip("distributed")
    for path in fleet.rglob("*.csv"):
        path.write_text("")
    words = [w if w != "1" else "2" for w in ONE]
    said = sysid("fit", fleet, *words, "-o", tmp_path / "out", "--json")
    assert said.code == 1
    assert set(said.json["failures"]) == {"a", "b", "broken"}
    for sentence in said.json["failures"].values():
        assert "crashed" not in sentence


def test_files_beside_the_folders_of_a_fleet_are_told(fleet, fitted, sysid, tmp_path):
    shutil.copy(LOW / "12.5mm_2.5Hz_0A.csv", fleet)
    (fleet / "README.txt").write_text("")
    words = [w for w in ONE if w != "--quiet"]
    said = sysid("fit", fleet, *words, "-o", tmp_path / "out")
    assert fitted == ["a", "b"]
    assert f"1 file beside the sub-folders of {fleet} is not read: 12.5mm_2.5Hz_0A.csv" in said.err


@pytest.mark.usefixtures("fitted")
def test_what_is_not_used_of_a_damper_is_told_with_its_name(fleet, sysid, tmp_path):
    """By the run that fits it, once: those that find it fitted tell nothing of it."""
    (fleet / "a" / "12.5mm_9Hz_0A.tdms").write_bytes(b"")
    held = "12.5mm_1.5Hz_0A"
    order = ("fit", fleet, *LOUD, "--exclude", held, "-o", tmp_path / "out")
    said = sysid(*order)
    told = [line for line in said.err.splitlines() if line.startswith("Note: ")]
    assert any(line.startswith("Note: a: ") and "tdms" in line for line in told)
    assert any(line.startswith(f"Note: b: {held} is left out") for line in told)
    said = sysid(*order)
    assert not any(words in said.err for words in ("Note: a: ", "Note: b: ", "left out"))


def test_what_lies_beside_the_files_now_is_told_and_not_what_did(fleet, fitted, sysid, tmp_path):
    """Wherever the fleet lies."""
    extra = fleet / "a" / "12.5mm_9Hz_0A.tdms"
    extra.write_bytes(b"")
    order = (*LOUD, "-o", tmp_path / "out")
    assert "tdms" in sysid("fit", fleet, *order).err
    moved = fleet.rename(tmp_path / "moved")
    assert "tdms" not in sysid("fit", moved, *order).err
    assert fitted == ["a", "b"]
    (moved / "a" / extra.name).unlink()
    sysid("fit", moved, *order)
    row = json.loads((tmp_path / "out" / module.ROWS).read_text().splitlines()[-1])
    assert (row["name"], row["notes"]) == ("a", [])


@pytest.mark.usefixtures("fitted")
def test_notes_of_a_fleet_have_one_limit_and_a_test_that_nobody_left_out_a_warning(
    fleet, sysid, tmp_path
):
    for name in ("a", "b"):
        for k in range(15):
            (fleet / name / f"{k}.toml").write_text("[files]\n")
        bad = "time_s,displacement_mm,force_N\n" + "".join(f"{k / 10},0,{k}\n" for k in range(50))
        (fleet / name / "still_12.5mm_3Hz_0A.csv").write_text(bad)
    said = sysid("fit", fleet, *LOUD, "-o", tmp_path / "out")
    lines = said.err.splitlines()
    assert sum(line.startswith(("Note: a: ", "Note: b: ")) for line in lines) == 20
    assert any(line.startswith("Note: … and ") for line in lines)
    warned = "Warning: a: still_12.5mm_3Hz_0A is left out"
    assert any(line.startswith(warned) for line in lines), said.err


def test_what_is_no_fleet_is_told(sysid, tmp_path):
    damper(tmp_path / "alone")
    out = tmp_path / "out"
    said = sysid("fit", tmp_path / "alone", *ONE, "-o", out)
    assert (said.code, "has no sub-folders" in said.err) == (1, True)
    (tmp_path / "empty" / "notes").mkdir(parents=True)
    said = sysid("fit", tmp_path / "empty", *ONE, "-o", out)
    assert (said.code, "no sub-folder holds a campaign" in said.err) == (1, True)
    said = sysid("fit", tmp_path / "alone", "--workers", "2", "-o", out)
    assert (said.code, "are for --each" in said.err) == (2, True)
    assert not out.exists()


def test_files_that_no_manifest_names_are_a_failure_with_advice(sysid, fleet, fitted, tmp_path):
    (fleet / "matlab").mkdir()
    (fleet / "matlab" / "test1.mat").write_bytes(b"MATLAB")
    said = sysid("fit", fleet, *ONE, "-o", tmp_path / "out")
    assert said.code == 1
    row = rows_of(tmp_path / "out")["matlab"]
    assert "there are .mat files" in row["verdict"]
    assert 'glob = "*.mat"' in row["verdict"]


def test_data_that_lie_elsewhere_are_looked_at(fitted, sysid, tmp_path):
    """The manifest names the folder; what is written beside it is none of them."""
    data = damper(tmp_path / "data")
    place = tmp_path / "fleet" / "a"
    place.mkdir(parents=True)
    (place / "campaign.toml").write_text('[files]\nfolder = "../../data"\n')
    out = tmp_path / "out"
    for _ in range(2):
        assert sysid("fit", tmp_path / "fleet", *ONE, "-o", out).code == 0
        (place / "fit.json").write_text("{}")
    assert len(fitted) == 1
    shutil.copy(LOW / "12.5mm_2.5Hz_0A.csv", data)
    assert sysid("fit", tmp_path / "fleet", *ONE, "-o", out).code == 0
    assert len(fitted) == 2


def refused(method, *places: Path):
    """A method of paths that is not permitted at some of them."""

    def instead(self, *arguments):
        if self in places:
            raise PermissionError(13, "Permission denied", str(self))
        return method(self, *arguments)

    return instead


def test_a_file_or_folder_that_cannot_be_read_stops_no_other(
    fleet, fitted, sysid, tmp_path, monkeypatch
):
    file, folder = fleet / "broken" / "12.5mm_0.5Hz_0A.csv", fleet / "locked"
    damper(folder)
    monkeypatch.setattr(Path, "read_bytes", refused(Path.read_bytes, file))
    monkeypatch.setattr(Path, "iterdir", refused(Path.iterdir, folder))
    out = tmp_path / "out"
    said = sysid("fit", fleet, *ONE, "-o", out)
    assert (said.code, fitted) == (1, ["a", "b"])
    table = rows_of(out)
    assert table["broken"]["verdict"].startswith("failed: ")
    assert "Permission denied" in table["locked"]["verdict"]
    monkeypatch.undo()
    assert module._may_be_campaign(folder)


def test_results_that_lie_in_the_fleet_are_no_dampers(fleet, fitted, sysid, tmp_path):
    (fleet / "broken").rename(tmp_path / "broken")
    link = tmp_path / "link"
    link.symlink_to(fleet)
    assert sysid("fit", fleet, *ONE, "-o", fleet / "old").code == 0
    for place in (fleet / "new", link / "new"):
        said = sysid("fit", fleet, *ONE, "-o", place)
        assert said.code == 0
        assert set(rows_of(place)) == {"a", "b"}
    fitted.clear()
    (fleet / "new" / module.ROWS).unlink()
    assert sysid("fit", fleet, *ONE, "-o", link / "new").code == 0
    assert fitted == ["a", "b"], "the folder itself, by another name"


def test_a_posterior_that_was_interrupted_is_no_finished_damper(
    fleet, fitted, sysid, tmp_path, monkeypatch
):
    """The chain itself takes Ctrl-C for "that is enough"."""
    honest = pipeline.identify
    ended = SimpleNamespace(posterior=SimpleNamespace(message="not converged: interrupted"))

    def stopped(campaign, selection, **options):
        return replace(honest(campaign, selection, **options), drawn=ended)

    monkeypatch.setattr(pipeline, "identify", stopped)
    out = tmp_path / "out"
    assert sysid("fit", fleet, *ONE, "-o", out).code == 130
    assert not (out / "a").exists()
    monkeypatch.setattr(pipeline, "identify", honest)
    said = sysid("fit", fleet, *ONE, "-o", out)
    assert "2 dampers fitted (0 of them before)" in said.out


def test_a_scheduler_brings_its_own_workers(fleet, sysid, tmp_path):
    order = ("fit", fleet, "--each", "--workers", "2", "--scheduler", "tcp://nowhere:1")
    said = sysid(*order, "-o", tmp_path / "out")
    assert (said.code, "not both" in said.err) == (2, True)
