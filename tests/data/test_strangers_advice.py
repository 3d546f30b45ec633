"""What strangers' folders are refused with: lines to paste, numbers that may mean two things.

Nothing is guessed in silence: what may be meant is proposed, and read once it is written down.
"""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from strangers import (
    CURRENTS,
    DISPLACEMENT,
    NO_CURRENT,
    ROWS,
    TIME,
    USUAL,
    Columns,
    assert_right,
    force,
    germans,
    manifest,
    names,
    pasted,
    refused,
    write_all,
)  # fmt: skip
from written_files import csv_text, write

from sysid.data.campaign import load_campaign
from sysid.data.manifest import read_manifest
from sysid.data.motion_file import read_motion
from sysid.data.quality import inspect
from sysid.errors import SysidError


def test_text_files_are_asked_for_in_the_words_of_the_advice(tmp_path):
    write_all(tmp_path, USUAL, name=lambda i: f"12.5mm_2Hz_{i}A.txt")
    pasted(tmp_path, refused(tmp_path).advice)
    assert_right(load_campaign(tmp_path))


def test_a_section_that_is_there_is_not_asked_for_again(tmp_path):
    """TOML refuses a second table of one name."""
    write_all(tmp_path, NO_CURRENT, name=lambda i: f"run-{i}A.txt")
    manifest(tmp_path, '[files]\nname = "run-{current}A"\n')
    found = re.search(r"Write under \[files\] in (\S+):\n(.*)", refused(tmp_path).advice)
    assert found
    path = Path(found[1])
    path.write_text(path.read_text(encoding="utf-8") + found[2] + "\n", encoding="utf-8")
    assert_right(load_campaign(tmp_path))


def test_files_in_sub_folders_are_asked_for(tmp_path):
    for ampere in CURRENTS:
        inner = tmp_path / f"{ampere} A"
        inner.mkdir()
        write(inner, f"12.5mm_2Hz_{ampere}A.csv", csv_text(USUAL(ampere)))
    pasted(tmp_path, refused(tmp_path).advice)
    assert_right(load_campaign(tmp_path))


def test_files_that_nothing_reads_are_called_so(tmp_path):
    write(tmp_path, "test 1.xls", b"\xd0\xcf\x11\xe0")
    error = refused(tmp_path)
    assert ".xls files are of no format" in error.what
    assert ".xlsx" in error.advice


def test_two_columns_of_force_are_told_apart_in_the_words_of_the_advice(tmp_path):
    write_all(tmp_path, lambda i: USUAL(i) | {"force_kN": np.zeros(ROWS)})
    error = refused(tmp_path)
    assert "if it is 'force_N'" in error.advice
    pasted(tmp_path, error.advice)
    assert_right(load_campaign(tmp_path))


def test_two_columns_of_one_name_are_to_be_renamed(tmp_path):
    """No line of a manifest can tell them apart."""
    write_all(tmp_path, USUAL, lambda c: csv_text(c).replace("current_A", "force_N"))
    assert "Rename" in refused(tmp_path).advice


FOREIGN = {
    "Chinese": ("时间(s)", "位移(mm)", "力(kN)", "UTF-8"),
    "French": ("Temps (s)", "Déplacement (mm)", "Effort (kN)", "latin-1"),
    "German": ("Zeit in s", "Weg in mm", "Kraft in kN", "cp1252"),
    "symbols": ("t/s", "x/mm", "F/kN", "UTF-16"),
}


@pytest.mark.parametrize("language", FOREIGN)
def test_foreign_headers_with_units_are_proposed_and_not_assumed(tmp_path, language):
    """Below a preamble; what is proposed can be pasted as it is."""
    *headers, encoding = FOREIGN[language]
    preamble = "Rig 3\n12.05.2024\n\n"
    write_all(tmp_path, names(*headers), lambda c: (preamble + germans(c)).encode(encoding))
    pasted(tmp_path, refused(tmp_path).advice)
    assert_right(load_campaign(tmp_path))


MTS = ("Time (s)", "Axial Displacement (mm)", "Axial Force (kN)")
LAYOUTS = {
    "tab": lambda c: csv_text(c, "\t"),
    "comma": csv_text,
    "comma and blank": lambda c: csv_text(c, ", "),
    "semicolon": germans,
    "preamble": lambda c: "MTS793\nDate: 12.05.2024 Time: 10:15\n\n" + csv_text(c, "\t"),
    "units row": lambda c: re.sub(r" \((\w+)\)", "", csv_text(c, "\t")).replace(
        "\n", "\ns\tmm\tkN\n", 1
    ),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_names_of_two_words_are_proposed_whole(tmp_path, layout):
    """Blanks part the names, not the columns: no line is called wrong, none is to be removed."""
    write_all(tmp_path, names(*MTS), LAYOUTS[layout])
    error = refused(tmp_path)
    assert error.what == "has no column for displacement and force"
    assert "Axial Displacement" in error.advice
    pasted(tmp_path, error.advice)
    assert_right(load_campaign(tmp_path))


def test_a_motion_with_names_of_two_words_is_told_its_columns(tmp_path):
    path = write(tmp_path, "motion.txt", csv_text(names(*MTS)(0.5), "\t"))
    with pytest.raises(SysidError, match="has no column for displacement") as caught:
        read_motion(path)
    pasted(tmp_path, caught.value.advice or "")
    read = read_motion(path, read_manifest(tmp_path / "campaign.toml"))
    np.testing.assert_allclose(read.displacement, DISPLACEMENT, atol=1e-9)


def test_japanese_text_is_read_with_the_encoding_that_is_asked_for(tmp_path):
    heard = "# 試験機 三号 ダンパ\n"
    write_all(tmp_path, USUAL, lambda c: (heard + csv_text(c)).encode("shift_jis"))
    pasted(tmp_path, refused(tmp_path).advice)
    assert_right(load_campaign(tmp_path))


def clock(stamp: str, separator: str = ",") -> Callable[[Columns], str]:
    def text(columns: Columns) -> str:
        decimal = "," if separator == ";" else "."
        header, *rows = csv_text(columns, separator, decimal).split("\n")[:-1]
        stamps = [stamp.format(s).replace(".", decimal) for s in TIME]
        rest = [row.split(separator, 1)[1] for row in rows]
        lines = [f"{s}{separator}{x}" for s, x in zip(stamps, rest, strict=True)]
        return "\n".join([header, *lines])

    return text


@pytest.mark.parametrize(
    "text",
    [clock("10:15:{:06.3f}"), clock("10:15:{:06.3f}", ";"), clock("2024-05-12T10:15:{:06.3f}")],
    ids=["points", "commas", "dates"],
)
def test_clock_times_lead_to_seconds(tmp_path, text):
    write_all(tmp_path, NO_CURRENT, text)
    error = refused(tmp_path)
    assert "line 2, column 'time_s'" in error.where
    assert "export time in seconds from the start of the test" in error.advice
    write_all(tmp_path, NO_CURRENT)
    assert_right(load_campaign(tmp_path))


def test_numbers_that_a_spreadsheet_made_dates_are_called_so(tmp_path):
    write_all(tmp_path, NO_CURRENT, germans)
    path = tmp_path / "12.5mm_2Hz_0.5A.csv"
    lines = path.read_text().split("\n")
    lines[40] = ";".join((*lines[40].split(";")[:2], "12. Mai"))
    path.write_text("\n".join(lines))
    error = refused(tmp_path)
    assert "line 41, column 'force_N'" in error.where
    assert "It is a date" in error.advice


def grouped(form: str, marks: str) -> Callable[[Columns], str]:
    """Forces with separators of thousands; `marks`: separator, then the decimal sign."""

    def text(columns: Columns) -> str:
        rows = ["time_ms;displacement_um;force_N"]
        for t, x, f in zip(*columns.values(), strict=True):
            cells = f"{1e3 * t:.0f};{1e3 * x:.0f};{form.format(f)}"
            rows.append(cells.translate(str.maketrans(",.", marks)))
        return "\n".join(rows)

    return text


@pytest.mark.parametrize(
    "text",
    [grouped("{:,.2f}", ".,"), grouped("{:,.2f}", "\u202f,"), grouped("{:,.2f}", ",.")],
    ids=["German", "French", "English"],
)
def test_separators_of_thousands_are_named(tmp_path, text):
    write_all(tmp_path, NO_CURRENT, text)
    error = refused(tmp_path)
    assert "force is not a number" in error.what
    assert "without separators of thousands" in error.advice


def test_commas_that_may_mean_either_are_no_decimal_commas(tmp_path):
    """1,567 N beside whole numbers: a thousandth of the force, or all of it, and nobody knows."""
    write_all(tmp_path, NO_CURRENT, grouped("{:,.0f}", ",."))
    error = refused(tmp_path)
    assert re.search(r"'(\d),(\d{3})' may be \1\2 or \1\.\2", error.what)
    assert "line" in error.where


def test_three_decimals_behind_a_comma_are_decimals(tmp_path):
    """What tells them from thousands is a zero in front."""

    def text(columns: Columns) -> str:
        rows = ["time_s;displacement_mm;force_kN"]
        for cells in zip(*columns.values(), strict=True):
            rows.append(";".join(f"{z:.3f}" for z in cells).replace(".", ","))
        return "\n".join(rows)

    write_all(tmp_path, names("time_s", "displacement_mm", "force_kN"), text)
    record = load_campaign(tmp_path).records[-1]
    np.testing.assert_allclose(record.force, force(0.5), atol=0.51)


def test_decimal_commas_in_quotes_between_commas(tmp_path):
    def text(columns: Columns) -> str:
        header, *rows = germans(columns).split("\n")[:-1]
        quoted = [",".join(f'"{cell}"' for cell in row.split(";")) for row in rows]
        return "\n".join([header.replace(";", ","), *quoted])

    write_all(tmp_path, NO_CURRENT, text)
    assert_right(load_campaign(tmp_path))


def minus(columns: Columns) -> str:
    return germans(columns).replace("-", "\u2212")


def fortran(columns: Columns) -> str:
    header, *rows = csv_text(columns).split("\n")[:-1]
    cells = [",".join(f"{float(z):.17E}".replace("E", "D") for z in r.split(",")) for r in rows]
    return "\n".join([header, *cells])


def uneven_ends(columns: Columns) -> str:
    """Three kinds of line ends, and three empty columns behind the last."""
    lines = csv_text(columns).split("\n")[:-1]
    ends = ("\n", "\r\n", "\r")
    return "".join(f"{line},,,{ends[k % 3]}" for k, line in enumerate(lines))


def header_again(columns: Columns) -> str:
    lines = csv_text(columns).split("\n")
    return "\n".join([*lines[:200], lines[0], *lines[200:]])


@pytest.mark.parametrize("text", [minus, fortran, uneven_ends, header_again])
def test_odd_text_is_read_exactly(tmp_path, text):
    write_all(tmp_path, NO_CURRENT, text)
    assert_right(load_campaign(tmp_path))


def test_a_time_without_a_unit_is_not_called_seconds(tmp_path):
    """Milliseconds are as usual: what is advised names them."""
    write_all(tmp_path, lambda i: {"time": TIME * 1e3} | dict(list(USUAL(i).items())[1:]))
    assert "(s, ms, us, min are known)" in refused(tmp_path).advice


@pytest.mark.parametrize(
    ("channel", "factor", "told"),
    [("time_s", 1e3, "1/1000 of the label"), ("displacement_mm", 1 / 25.4, "1/25.4 of the label")],
)
def test_a_header_with_the_wrong_unit_is_told_by_the_label(tmp_path, channel, factor, told):
    write_all(tmp_path, lambda i: USUAL(i) | {channel: USUAL(i)[channel] * factor})
    said = [f.evidence for t in inspect(load_campaign(tmp_path)).tests for f in t.faults]
    assert sum(told in sentence for sentence in said) == len(CURRENTS)


@pytest.mark.parametrize(
    "name",
    [
        lambda i: f"12,5mm_2Hz_{i}A".replace(".", ",") + ".csv",
        lambda i: f"12,5mm,2Hz,{i}A".replace("A", "A ").replace(".", ",").strip() + ".csv",
    ],
    ids=["between underscores", "between commas"],
)
def test_decimal_commas_in_file_names(tmp_path, name):
    write_all(tmp_path, NO_CURRENT, name=name)
    campaign = load_campaign(tmp_path)
    assert campaign.notes == ()
    assert [record.nominal.current for record in campaign.records] == list(CURRENTS)
    assert {record.nominal.amplitude for record in campaign.records} == {0.0125}


def test_a_name_that_is_nearly_understood_is_not_passed_over_in_silence(tmp_path):
    write_all(tmp_path, NO_CURRENT, name=lambda i: f"12.5mm@2Hz_{i}A.csv")
    campaign = load_campaign(tmp_path)
    (note,) = (note for note in campaign.notes if "'12.5mm@2Hz' in the name" in note)
    assert note.startswith(f"{len(CURRENTS)} names (12.5mm@2Hz_"), "one sentence for all"
    assert all(record.nominal.amplitude is None for record in campaign.records)
