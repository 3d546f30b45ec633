"""Input that is wrong ends in one message that names file and place; what is odd but sound is read.

Each case spoils a sound campaign of one test, and says which words the message must hold.
"""

import os
import tomllib
from pathlib import Path

import numpy as np
import pytest
from bad_files import (
    Build,
    beside,
    flipped,
    half,
    line,
    mat4_bytes,
    other,
    ragged,
    raw,
    text,
    with_nan,
    without,
)
from written_files import (
    csv_text,
    mat5_bytes,
    mat73_bytes,
    measured,
    parquet_bytes,
    tdms_bytes,
    write,
    xlsx_bytes,
)

from sysid.data.campaign import load_campaign
from sysid.errors import DataError, SysidError

SOUND = csv_text(measured())
ROWS = SOUND.split("\n")

CASES: dict[str, tuple[Build, tuple[str, ...]]] = {
    # columns and units
    "missing column": (text("force_N", "load_N"), ("a.csv", "no column for force", "'load_N'")),
    "no header": (raw("\n".join(ROWS[1:])), ("a.csv", "no header", "time_s")),
    "other header": (raw("a,b,c\n" + "\n".join(ROWS[1:])), ("a.csv", "no header", "'a', 'b', 'c'")),
    "wrong unit": (text("force_N", "force_stone"), ("a.csv", "'stone'", "N, kN, lbf")),
    "unit of another": (text("force_N", "force_mm"), ("a.csv", "'mm' is a unit of displacement")),
    "no unit": (text("force_N", "force"), ("a.csv", "column 'force'", "no unit", "force_N")),
    "bad units row": (
        raw("time,displacement,force\ns,mm,stone\n" + "\n".join(ROWS[1:])),
        ("a.csv", "'stone'", "force"),
    ),
    "force twice": (
        text("force_N", "force_N", **{"force (kN)": np.ones(60)}),
        ("a.csv", "'force_N' and 'force (kN)' both hold force"),
    ),
    "manifest names a column that is absent": (
        beside("campaign.toml", '[columns]\nforce = { column = "F", unit = "N" }'),
        ("a.csv", "column 'F' is missing", "'force_N'"),
    ),
    "manifest names one column as another": (
        beside("campaign.toml", '[columns]\nforce = { column = "displacement_mm" }'),
        ("campaign.toml, line 2", "'displacement_mm' is named as force", "says displacement"),
    ),
    "manifest takes a column away": (
        beside("campaign.toml", '[columns]\nforce = { column = "displacement_mm", unit = "N" }'),
        ("a.csv", "no column for displacement", "'displacement_mm' is named as force in campaign"),
    ),
    "header of a megabyte": (raw("x" * 1_000_000 + "\n" + "1,2\n"), ("a.csv", "no header")),
    # cells
    "text in numbers": (line(9, "0.07,1.0,abc"), ("a.csv, line 9", "'force_N'", "'abc'")),
    "underscore in numbers": (line(9, "0.07,1.0,1_000"), ("line 9", "'1_000'")),
    "line of words": (line(9, "garbage"), ("a.csv, line 9", "text", "garbage")),
    "NaN": (line(9, "0.07,1.0,NaN"), ("a.csv, line 9", "force is empty or not a finite")),
    "infinite": (line(9, "0.07,-inf,1.0"), ("a.csv, line 9", "displacement", "not a finite")),
    "empty cell": (line(9, "0.07,,1.0"), ("a.csv, line 9", "displacement is empty")),
    "huge number": (line(9, "0.07,1.0,1e300"), ("a.csv, line 9", "force is 1e+300 N")),
    "cut short": (line(61, "0.59,1.0"), ("a.csv, line 61", "2 cells, the header 3")),
    "too many cells": (line(9, "0.07,1.0,2.0,3.0"), ("a.csv, line 9", "4 cells, the header 3")),
    "a cell too many in every row": (
        raw(SOUND.replace("\n", ",871\n").replace(",871", "", 1)),
        ("a.csv, line 2", "4 cells, the header 3"),
    ),
    "two units for one column": (
        raw(SOUND.replace("\n", "\ns,mm,kN\n", 1)), ("'force_N'", "'N'", "'kN'", "campaign.toml"),
    ),
    "decimal comma between commas": (
        raw(csv_text(measured(), ",", ",")),
        ("a.csv, line 2", "6 cells", "semicolon"),
    ),
    "two decimal signs": (
        raw(SOUND.replace(",", ";").replace("\n0.07;", "\n0,07;")),
        ("a.csv, line 9", "time is not a number: '0,07'"),
    ),
    "failed formula for a time": (
        line(9, "#N/A,1.0,2.0"), ("a.csv, line 9", "time is not a number: '#N/A'", "formula"),
    ),
    "failed formula in German": (line(9, "#WERT!,1.0,2.0"), ("line 9", "'#WERT!'", "formula")),
    "failed row": (line(9, "#N/A,#N/A,#N/A"), ("a.csv, line 9", "'#N/A'")),
    "thousands beside a point that is no number": (
        raw("time_ms;displacement_um;force_N;remark\n0;1;1,234;v1.2\n10;2;987;v1.2\n20;3;1,100;x"),
        ("a.csv, line 2", "'1,234' may be 1234 or 1.234"),
    ),
    "thousands beside a comma that is no number": (
        raw("time_ms;displacement_um;force_N;remark\n0;1;987;a, b\n10;2;-1,234;\n20;3;0;x"),
        ("a.csv, line 3", "'-1,234' may be -1234 or -1.234"),
    ),
    "quoted thousands between commas": (
        raw('time_ms,displacement_um,force_N\n0,1,987\n10,2,"1,234"\n20,3,"1,100"'),
        ("a.csv, line 3", "'1,234' may be 1234 or 1.234"),
    ),
    "quoted thousands beside points": (
        raw('time_s,displacement_mm,force_N\n0.01,1,987\n0.02,2,"1,234"\n0.03,3,"1,100"'),
        ("a.csv, line 3", "force is not a number: '1,234'", "separators of thousands"),
    ),
    "list with cells beyond its header": (
        beside("tests.csv", "file,current_A\na.csv,0,5\n"),
        ("tests.csv, line 2", "3 cells, the header 2", "semicolon"),
    ),
    "open quote": (line(9, '0.07,"1.0,2.0'), ("a.csv, line 9",)),
    "NUL byte": (raw(SOUND.replace("0.07,", "0.0\x00,")), ("a.csv", "NUL byte in line 9")),
    "unreadable encoding": (
        raw(b"\x81\x8d" + SOUND.encode()), ("a.csv", "not text in a known encoding"),
    ),
    "unknown encoding": (
        beside("campaign.toml", '[files]\nencoding = "utf-9"'), ("a.csv", "'utf-9'"),
    ),
    "wrong encoding": (
        beside("campaign.toml", '[files]\nencoding = "utf-16"'), ("a.csv", "no header"),
    ),
    "random bytes": (raw(np.random.default_rng(0).bytes(5000)), ("a.csv", "not text")),
    # rows and time
    "empty file": (raw(""), ("a.csv", "is empty")),
    "blank file": (raw(" \n\n\t\n"), ("a.csv", "is empty")),
    "only a header": (raw(ROWS[0] + "\n"), ("a.csv", "0 row")),
    "one row": (raw("\n".join(ROWS[:2])), ("a.csv", "1 row")),
    "time backwards": (line(9, "0.01,1.0,2.0"), ("a.csv, line 9", "time goes backwards")),
    "two tests without a key": (
        raw(SOUND + "\n".join(ROWS[1:])), ("a.csv, line 62", "time goes backwards", "`test`"),
    ),
    "time stands still": (
        text("time_s", "time_s", time_s=np.zeros(60)), ("a.csv", "repeat in 59 of 60 rows"),
    ),
    "empty test key": (
        raw("\n".join([ROWS[0] + ",test", ROWS[1] + ",a", ROWS[2] + ","])),
        ("a.csv, line 3", "test column is empty"),
    ),
    "conditions change on every row": (
        text("time_s", "time_s", amplitude_mm=np.arange(60.0)),
        ("a.csv", "cannot be told apart", "`test`"),
    ),
    "unknown kind": (
        text("time_s", "time_s", kind=np.repeat("square", 60)), ("a.csv", "'square'", "triangle"),
    ),
    # other formats
    "truncated mat": (other("a.mat", half(mat5_bytes(measured()))), ("a.mat", "MATLAB")),
    "truncated mat v7.3": (other("a.mat", half(mat73_bytes(measured()))), ("a.mat", "MATLAB")),
    "truncated xlsx": (other("a.xlsx", half(xlsx_bytes(measured()))), ("a.xlsx", "Excel")),
    "truncated tdms": (other("a.tdms", half(tdms_bytes(measured()))), ("a.tdms", "cut short")),
    "truncated parquet": (
        other("a.parquet", half(parquet_bytes(measured()))), ("a.parquet", "Parquet"),
    ),
    "mat with one bit of its flags turned": (
        other("a.mat", flipped(mat5_bytes(measured()), 145, 0x7F)), ("a.mat", "MATLAB"),
    ),
    "mat of level 4": (
        other("a.mat", mat4_bytes(measured())), ("a.mat", "no MATLAB file of level 5 or 7.3"),
    ),
    "mat without force": (
        other("a.mat", mat5_bytes(without("force_N"))), ("a.mat", "no column for force"),
    ),
    "mat with one variable": (
        other("a.mat", mat5_bytes({"x": np.ones(9)})), ("a.mat", "'x'", "time_s"),
    ),
    "mat with columns of two lengths": (
        other("a.mat", mat5_bytes(ragged())), ("a.mat", "'force_N' has 57 values"),
    ),
    "mat with a complex column": (
        other("a.mat", mat5_bytes({**measured(), "force_N": np.ones(60) * 1j})),
        ("a.mat", "'force_N'", "complex"),
    ),
    "mat with NaN": (other("a.mat", mat5_bytes(with_nan())), ("a.mat, sample 7", "'force_N'")),
    "xlsx without header": (
        other("a.xlsx", xlsx_bytes({"p": np.ones(3)})), ("a.xlsx", "no header", "'p'"),
    ),
    "xlsx with text in numbers": (
        other("a.xlsx", xlsx_bytes({**measured(), "force_N": np.repeat("x", 60)})),
        ("a.xlsx, row 2", "'x'"),
    ),
    "tdms without force": (
        other("a.tdms", tdms_bytes({"p": np.ones(3)})), ("a.tdms", "'data/p'"),
    ),
    "tdms without time": (
        other("a.tdms", tdms_bytes(without("time_s"))), ("a.tdms", "wf_increment", "time_s"),
    ),
    "parquet without a known column": (
        other("a.parquet", parquet_bytes({"p": np.ones(3)})), ("a.parquet", "'p'"),
    ),
    "empty mat": (other("a.mat", b""), ("a.mat", "is empty")),
    "text called mat": (other("a.mat", SOUND), ("a.mat", "MATLAB")),
    "text called xlsx": (other("a.xlsx", SOUND), ("a.xlsx", "Excel")),
    "text called tdms": (other("a.tdms", SOUND), ("a.tdms", "TDMS")),
    "text called parquet": (other("a.parquet", SOUND), ("a.parquet", "Parquet")),
    "workbook called csv": (raw(xlsx_bytes(measured())), ("a.csv", "not text")),
    "unknown format": (other("a.docx", b"PK"), ("a.docx", "'.docx'", ".parquet")),
    # manifest and list of tests
    "unknown manifest key": (
        beside("campaign.toml", '[files]\nglobs = "*.csv"'),
        ("campaign.toml, line 2", "'files.globs'", "'glob'"),
    ),
    "manifest is no TOML": (
        beside("campaign.toml", "[files\n"), ("campaign.toml", "not valid TOML", "line 1"),
    ),
    "manifest with a wrong unit": (
        beside("campaign.toml", '[constants]\ntemperature = { value = 1, unit = "mm" }'),
        ("campaign.toml, line 2", "'mm'", "temperature"),
    ),
    "manifest names no folder": (
        beside("campaign.toml", '[files]\nfolder = "nowhere"'), ("campaign.toml", "nowhere"),
    ),
    "glob that cannot be": (beside("campaign.toml", '[files]\nglob = "/a/**"'), ("'/a/**'",)),
    "listed file absent": (
        beside("tests.csv", "file,current_A\na.csv,1\nb.csv,1\n"), ("tests.csv, line 3", "'b.csv'"),
    ),
    "listed twice": (beside("tests.csv", "file\na.csv\na.csv\n"), ("tests.csv", "lines 2 and 3")),
    "list without file": (beside("tests.csv", "name\na.csv\n"), ("tests.csv, line 1", "'file'")),
    "list with a bad number": (
        beside("tests.csv", "file,current_A\na.csv,1 A\n"),
        ("tests.csv, line 2", "'current_A'", "'1 A'"),
    ),
    "list with a bad kind": (
        beside("tests.csv", "file,kind\na.csv,saw\n"), ("tests.csv, line 2", "'saw'", "sine"),
    ),
    "list with a bad unit": (
        beside("tests.csv", "file,current_K\na.csv,1\n"), ("tests.csv, line 1", "'K'", "current"),
    ),
    "list with run orders twice": (
        beside("tests.csv", "file,run_order\na.csv#1,1\na.csv,1\n"),
        ("tests.csv, line 3", "run_order 1"),
    ),
    "list that is no text": (beside("tests.csv", b"\x00\x01file"), ("tests.csv", "not text")),
    # the file system
    "folder called csv": (lambda folder: (folder / "a.csv").mkdir(), ("a.csv", "is a folder")),
    "link to itself": (
        lambda folder: (folder / "a.csv").symlink_to(folder / "a.csv"), ("a.csv", "cannot be read"),
    ),
    "link to nothing": (
        lambda folder: (folder / "a.csv").symlink_to("gone"), ("a.csv", "cannot be read"),
    ),
    "pipe": (lambda folder: os.mkfifo(folder / "a.csv"), ("a.csv", "no regular file")),
    "nothing there": (lambda folder: None, ("holds no data file", "*.csv")),
    "one id twice": (
        lambda folder: (write(folder, "a.csv", SOUND), write(folder, "a.CSV", SOUND)),
        ("id 'a'", "a.CSV", "a.csv"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_bad_input_gives_one_message_with_file_and_place(tmp_path, name):
    build, words = CASES[name]
    build(tmp_path)
    with pytest.raises(SysidError) as caught:
        load_campaign(tmp_path)
    message = str(caught.value)
    for word in words:
        assert word in message, message
    sentence, _, lines = message.partition(":\n")
    assert "\n" not in sentence
    tomllib.loads(lines)  # what follows is there to be pasted
    assert len(message) < 900


def test_at_least_forty_bad_inputs_are_tried():
    assert len(CASES) >= 40


@pytest.mark.parametrize("given", ["gone", "file.csv", "loop"])
def test_a_campaign_that_is_no_folder(tmp_path, given):
    write(tmp_path, "file.csv", SOUND)
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(DataError, match=given):
        load_campaign(tmp_path / given)


@pytest.mark.parametrize("name", ["a.csv", "campaign.toml", "tests.csv"])
def test_no_permission_to_read(tmp_path, monkeypatch, name):
    write(tmp_path, "a.csv", SOUND)
    write(tmp_path, "campaign.toml", "")
    write(tmp_path, "tests.csv", "file\na.csv\n")
    read_bytes = Path.read_bytes

    def refuse(path: Path) -> bytes:
        if path.name == name:
            raise PermissionError(13, "Permission denied", str(path))
        return read_bytes(path)

    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(SysidError, match="Permission denied") as caught:
        load_campaign(tmp_path)
    assert name in str(caught.value)


def test_a_manifest_that_is_absent(tmp_path):
    write(tmp_path, "a.csv", SOUND)
    with pytest.raises(SysidError, match=r"gone\.toml"):
        load_campaign(tmp_path, tmp_path / "gone.toml")


def test_a_file_name_that_is_no_text(tmp_path):
    with open(os.fsencode(tmp_path) + b"/\xff.csv", "w") as file:
        file.write(SOUND)
    with pytest.raises(DataError, match="not valid text") as caught:
        load_campaign(tmp_path)
    assert str(caught.value).encode()


ODD: dict[str, Build] = {
    "blank lines within": raw(SOUND.replace("\n0.3,", "\n\n \n0.3,")),
    "separator at each end": raw("\n".join(row + "," for row in ROWS[:-1])),
    "no newline at the end": raw(SOUND.rstrip()),
    "carriage returns alone": raw(SOUND.replace("\n", "\r")),
    "quoted cells": raw("\n".join(",".join(f'"{c}"' for c in r.split(",")) for r in ROWS[:-1])),
    "blanks around cells": raw(SOUND.replace(",", " ,  ")),
    "comments": raw("# rig 4\n" + SOUND.replace("\n0.3,", "\n# valve opened\n0.3,")),
    "long preamble": raw("note, with time and force\n" * 1500 + SOUND),
    "capital header": raw(SOUND.replace("time_s", "Time_s").replace("force_N", "FORCE_N")),
    "byte-order mark": raw("\ufeff" + SOUND),
    "another ending": lambda folder: write(folder, "a.CSV", SOUND),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_but_sound_files_are_read_correctly(tmp_path, name):
    ODD[name](tmp_path)
    (record,) = load_campaign(tmp_path).records
    columns = measured()
    np.testing.assert_allclose(record.time, columns["time_s"], atol=1e-12)
    np.testing.assert_allclose(record.displacement, columns["displacement_mm"] * 1e-3)
    np.testing.assert_allclose(record.force, columns["force_N"])
