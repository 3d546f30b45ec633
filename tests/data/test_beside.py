"""What lies beside the tests of a campaign is told of, wherever it could be read and is not."""

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from written_files import csv_text, mat5_bytes, measured, tdms_bytes, write, xlsx_bytes

from sysid.data import beside
from sysid.data.campaign import load_campaign
from sysid.errors import ManifestError

FOREIGN: dict[str, np.ndarray] = dict(
    zip(("Zeit", "Weg", "Kraft"), measured().values(), strict=True)
)


def sound(folder: Path, name: str = "a.csv") -> Path:
    folder.mkdir(exist_ok=True)
    return write(folder, name, csv_text(measured()))


def test_files_of_another_format_are_told(tmp_path):
    sound(tmp_path)
    write(tmp_path, "b.mat", mat5_bytes(measured()))
    write(tmp_path, "c.TDMS", b"TDSm")
    for name in ("README.txt", "photo.png", ".hidden.mat", "LICENSE"):
        write(tmp_path, name, "")
    (note,) = load_campaign(tmp_path).notes
    assert "2 files in" in note
    assert "'*.csv' does not match: b.mat, c.TDMS." in note
    write(tmp_path, "campaign.toml", '[files]\nglob = "a.*"\n')
    write(tmp_path, "d.csv", csv_text(measured()))
    (note,) = load_campaign(tmp_path).notes
    assert "3 files in" in note, "those that the user's own glob leaves out, too"


def test_files_in_sub_folders_are_told(tmp_path):
    sound(tmp_path)
    sound(tmp_path / "second day")
    sound(tmp_path / "second day", "b.xlsx")
    sound(tmp_path / ".cache")
    (tmp_path / "photos").mkdir()
    write(tmp_path / "photos", "rig.png", "")
    (note,) = load_campaign(tmp_path).notes
    assert "2 files in sub-folders of" in note
    assert "are not read (second day)" in note


@pytest.mark.parametrize(
    "manifest", ['[files]\nglob = "raw/*.csv"\n', '[files]\nfolder = "raw"\n'],
    ids=["files of a sub-folder", "another folder"],
)  # fmt: skip
def test_files_beside_a_manifest_that_names_others_are_told(tmp_path, manifest):
    sound(tmp_path, "loose.csv")
    sound(tmp_path / "raw", "b.csv")
    write(tmp_path, "campaign.toml", manifest)
    (note,) = load_campaign(tmp_path).notes
    assert "1 file in" in note
    assert "loose.csv" in note


@pytest.mark.parametrize("content", ["file,current_A\na.csv,1\n", "File;Current_A\na.csv;1\n"])
def test_a_list_of_tests_under_another_name_is_refused_where_it_would_be_a_test(tmp_path, content):
    sound(tmp_path)
    write(tmp_path, "test.csv", content)
    with pytest.raises(ManifestError, match=r"test\.csv: lists tests.* Rename it to tests\.csv"):
        load_campaign(tmp_path)


def test_a_list_of_tests_under_another_name_is_told_where_it_is_not_read(tmp_path):
    sound(tmp_path, "a.txt")
    write(tmp_path, "campaign.toml", '[files]\nglob = "a.txt"\n')
    write(tmp_path, "manifest.csv", "file,current_A\na.txt,1\n".encode("utf-16"))
    (note,) = load_campaign(tmp_path).notes
    assert "manifest.csv in" in note
    assert "Rename it to tests.csv" in note


def test_a_second_list_and_a_manifest_under_another_name_are_told(tmp_path):
    sound(tmp_path)
    write(tmp_path, "tests.csv", "file,current_A\na.csv,1\n")
    write(tmp_path, "Tests.CSV", "file,current_A\na.csv,2\n")
    if len(list(tmp_path.iterdir())) == 2:
        pytest.skip("this file system does not tell upper from lower case")
    write(tmp_path, "manifest.toml", "# rig\n[files]\n")
    write(tmp_path, "pyproject.toml", "[tool.ruff.files]\nname = 'a'\n")
    campaign = load_campaign(tmp_path)
    assert campaign.records[0].nominal.current == 1.0
    told = " ".join(campaign.notes)
    assert "Tests.CSV is not read" in told
    assert "manifest.toml is not read" in told
    assert "pyproject" not in told, "it says nothing of what a manifest says"
    assert "toml" not in " ".join(load_campaign(tmp_path, tmp_path / "manifest.toml").notes)


@pytest.mark.parametrize(
    "preamble", ["File,10mm_2Hz_1A.raw", "File;C:\\data\\1.raw;current 1 A", "File"]
)
def test_a_test_whose_first_line_names_a_file_is_no_list(tmp_path, preamble):
    write(tmp_path, "a.csv", f"{preamble}\n{csv_text(measured())}")
    assert [record.id for record in load_campaign(tmp_path).records] == ["a"]


def test_a_long_table_with_a_column_of_files_is_no_list(tmp_path):
    """Its condition stands in it, so that it begins as a list does."""
    columns = measured() | {"current_A": np.ones(60), "file": np.array(["r1"] * 60)}
    text = csv_text(
        dict(zip(("t", "pos", "load", "current_A", "file"), columns.values(), strict=True))
    )
    write(tmp_path, "a.csv", text)
    named = {"time": ("t", "s"), "displacement": ("pos", "mm"), "force": ("load", "N")}
    lines = [f'{role} = {{ column = "{c}", unit = "{u}" }}' for role, (c, u) in named.items()]
    lines += ['test = { column = "file" }']
    write(tmp_path, "campaign.toml", "\n".join(["[columns]", *lines]))
    (record,) = load_campaign(tmp_path).records
    assert record.nominal.current == 1.0


def test_nothing_is_to_be_written_over_the_list_of_tests(tmp_path):
    sound(tmp_path)
    write(tmp_path, "tests.csv", "file,current_A\na.csv,1\n")
    write(tmp_path, "tests_old.csv", "file,current_A\na.csv,2\n")
    with pytest.raises(ManifestError, match=r"a second list of tests beside .*tests\.csv") as told:
        load_campaign(tmp_path)
    assert "Rename" not in str(told.value)
    write(tmp_path, "campaign.toml", '[files]\nglob = "a.csv"\n')
    (note,) = load_campaign(tmp_path).notes
    assert "tests_old.csv in" in note
    assert "is a second list of tests" in note
    assert "Rename" not in note


def test_a_list_may_call_its_files_file_in_capitals(tmp_path):
    sound(tmp_path)
    write(tmp_path, "tests.csv", "File;Amplitude_mm\na.csv;5\n")
    assert load_campaign(tmp_path).records[0].nominal.amplitude == pytest.approx(0.005)


def test_what_no_test_can_be_is_not_told(tmp_path):
    """Prose, sums of files, results, and what a line on `tests.csv` tells already."""
    sound(tmp_path)
    write(tmp_path, "LIESMICH.txt", "Am 3.4.2024 gemessen, 5 mm, 2 Hz, 1 A, 20 °C.\n")
    write(tmp_path, "requirements.txt", "numpy==2.1\nscipy>=1.0\n")
    write(tmp_path, "tests.csv", "file\na.csv\nb.mat\n")
    write(tmp_path, "b.mat", "")
    (tmp_path / "photos").mkdir()
    write(tmp_path / "photos", "caption.txt", "the rig")
    sound(tmp_path / "out", "force.csv")
    write(tmp_path / "out", "card.json", "{}")
    notes = load_campaign(tmp_path).notes
    assert notes[0] == "tests.csv lists 'b.mat', which '*.csv' does not match: not read"
    assert len(notes) == 2, "and its line"
    write(tmp_path, "sums.txt", "file\tsha\na.csv\tabc\n")
    assert load_campaign(tmp_path).notes == notes, "it tells no condition"
    for text in (csv_text(measured(), "\t", ","), csv_text(measured(), ", ")):
        write(tmp_path, "c.txt", f"Rig 3\nOperator: x\n{text}")
        assert "c.txt" in " ".join(load_campaign(tmp_path).notes)


def test_folders_of_very_many_files_are_not_gone_through(tmp_path, monkeypatch):
    sound(tmp_path)
    for name in ("one", "two", "zoo"):
        (tmp_path / name).mkdir()
        for k in range(600):
            (tmp_path / name / f"{k}.txt").touch()
    opened: list[Path] = []
    honest = beside.looks_like_listing
    monkeypatch.setattr(beside, "looks_like_listing", lambda p: opened.append(p) or honest(p))
    (note,) = load_campaign(tmp_path).notes
    assert note.startswith(f"more than 1000 files in sub-folders of {tmp_path} are not read (one, ")
    assert "zoo" not in note
    assert len(opened) < 100


def test_names_that_are_no_text_are_told_so_that_they_can_be_written(tmp_path):
    sound(tmp_path)
    try:
        (tmp_path / "b\udcff.mat").write_bytes(b"")
    except OSError:
        pytest.skip("this file system has no such names")
    (note,) = load_campaign(tmp_path).notes
    assert "b\\xff.mat" in note


def matlab(**structs: Mapping[str, np.ndarray | str]) -> bytes:
    out = BytesIO()
    columns = {
        name: {k: v if isinstance(v, str) else v.reshape(-1, 1) for k, v in struct.items()}
        for name, struct in structs.items()
    }
    savemat(out, columns)
    return out.getvalue()


MATLAB = {
    "a": measured(),
    "b": FOREIGN,
    "rig": {"name": "three", "rate": np.ones((1, 1))},
    "peaks": {"force_N": np.ones((3, 1)), "displacement_mm": np.ones((3, 1))},
}  # fmt: skip
PARTS = {
    "Excel": ("a.xlsx", xlsx_bytes(measured(), B=FOREIGN), "B is not read"),
    "MATLAB": ("a.mat", mat5_bytes, "b is not read: of 'Zeit', 'Weg', 'Kraft'"),
    "TDMS": ("a.tdms", tdms_bytes(measured(), B=FOREIGN), "group B is not read"),
}


@pytest.mark.parametrize("form", PARTS)
def test_parts_with_foreign_headers_beside_a_whole_one_are_told(tmp_path, form):
    name, content, words = PARTS[form]
    if callable(content):
        content = matlab(**MATLAB)
    write(tmp_path, name, content)
    write(tmp_path, "campaign.toml", '[files]\nglob = "a.*"\n')
    campaign = load_campaign(tmp_path)
    assert [record.id for record in campaign.records] == ["a"]
    (note,) = campaign.notes
    assert words in note
    assert "[columns]" in note


def test_a_summary_beside_the_tests_refuses_no_workbook(tmp_path):
    summary = {"test": np.array(["data"]), "amplitude_mm": np.ones(1), "force_N": np.ones(1)}
    write(tmp_path, "a.xlsx", xlsx_bytes(measured(), second=measured(), Summary=summary))
    write(tmp_path, "campaign.toml", '[files]\nglob = "a.*"\n')
    campaign = load_campaign(tmp_path)
    assert [record.id for record in campaign.records] == ["a#data", "a#second"]
    assert campaign.notes == (), "a row is no recording"


PEAKS = {"time_s": np.arange(20.0), "force_N": np.ones(20)}
PEAKS_IN = {
    "Excel": ("a.xlsx", lambda: xlsx_bytes(measured(), Peaks=PEAKS), "sheet Peaks is not read"),
    "MATLAB": ("a.mat", lambda: matlab(a=measured(), Peaks=PEAKS), "Peaks is not read"),
    "TDMS": ("a.tdms", lambda: tdms_bytes(measured(), Peaks=PEAKS), "group Peaks is not read"),
}


@pytest.mark.parametrize("form", PEAKS_IN)
def test_time_and_one_quantity_alone_refuse_no_file_and_are_told(tmp_path, form):
    name, made, words = PEAKS_IN[form]
    write(tmp_path, name, made())
    write(tmp_path, "campaign.toml", '[files]\nglob = "a.*"\n')
    campaign = load_campaign(tmp_path)
    assert [record.id for record in campaign.records] == ["a"]
    (note,) = campaign.notes
    assert note.startswith(f"{name}: {words}")


def test_parts_of_many_files_are_told_once_and_small_ones_not(tmp_path):
    small = {"Bediener": np.array(["x"] * 9), "Nr": np.arange(9.0), "Wert": np.ones(9)}
    for k in range(5):
        book = xlsx_bytes(measured(), Rig=small, B=FOREIGN)
        write(tmp_path, f"{k}.xlsx", book)
    write(tmp_path, "campaign.toml", '[files]\nglob = "*.xlsx"\n')
    (note,) = load_campaign(tmp_path).notes
    assert note.startswith("5 files (0.xlsx, 1.xlsx, 2.xlsx, …): sheet B is not read")
    group = {"one": np.arange(9.0), "two": np.ones(9)}
    for k in range(5):
        write(tmp_path, f"{k}.tdms", tdms_bytes(measured(), Rig=group, B=FOREIGN))
    write(tmp_path, "campaign.toml", '[files]\nglob = "*.tdms"\n')
    notes = load_campaign(tmp_path).notes
    assert notes[-1].startswith("5 files (0.tdms, 1.tdms, 2.tdms, …): group B is not read")
    assert "Rig" not in " ".join(notes)


def test_a_sheet_that_lacks_one_column_is_refused_as_before(tmp_path):
    lacking = {k: v for k, v in measured().items() if k != "force_N"} | {"Kraft": np.ones(60)}
    write(tmp_path, "a.xlsx", xlsx_bytes(measured(), second=lacking))
    write(tmp_path, "campaign.toml", '[files]\nglob = "a.*"\n')
    with pytest.raises(Exception, match="second: has no column for force"):
        load_campaign(tmp_path)


def test_what_holds_of_many_names_is_told_once_and_after_what_contradicts(tmp_path):
    for k in range(23):
        write(tmp_path, f"{k + 1}mm_2Hz_1A_1_C.csv", csv_text(measured()))
    write(tmp_path, "5mm_2Hz_3Hz.csv", csv_text(measured()))
    write(tmp_path, "tests.csv", "file,amplitude_mm\n1mm_2Hz_1A_1_C.csv,2\n")
    notes = load_campaign(tmp_path).notes
    *before, many, twice = notes
    assert many.startswith("23 names (10mm_2Hz_1A_1_C, 11mm_2Hz_1A_1_C, 12mm_2Hz_1A_1_C, …): '1_C'")
    assert twice.startswith("5mm_2Hz_3Hz: the name tells frequency 2 times")
    assert any("1mm_2Hz_1A_1_C" in note and "amplitude" in note for note in before)
