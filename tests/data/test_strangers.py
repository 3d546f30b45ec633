"""Folders as strangers bring them: read rightly, or refused with advice that works in one step.

The same three tests of one damper are written in many ways. Where a folder is refused, the test
does what the message says, to the letter, once.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

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
    refused,
    replace_in_all,
    write_all,
)  # fmt: skip
from written_files import csv_text, write

from sysid.data.campaign import load_campaign
from sysid.data.quality import inspect
from sysid.errors import SysidError
from sysid.identification.problem import loop_problem


def bom(columns: Columns) -> bytes:
    return germans(columns).replace("\n", "\r\n").encode("utf-8-sig")


def unicode_text(columns: Columns) -> bytes:
    return csv_text(columns, "\t", ",").encode("utf-16")


def shuffled(columns: Columns) -> str:
    """Another order, with columns between that mean nothing here."""
    extra = {"sample": np.arange(ROWS) + 1.0, **dict(reversed(list(columns.items())))}
    return csv_text(extra | {"valve command": np.zeros(ROWS)}, ";")


def units_below(columns: Columns) -> str:
    lines = csv_text(columns, "\t").split("\n")
    return "\n".join(["Test rig 3", "operator;unknown", "", lines[0], "s\tmm\tkN\tA", *lines[1:]])


def rounded_blanks(columns: Columns) -> str:
    lines = csv_text(columns, " ").split("\n")
    return "\n".join(line.replace(" ", "    ") for line in lines)


READ: dict[str, Callable[[Path], None]] = {
    "semicolons, decimal commas, mm, kN": lambda f: write_all(
        f, names("time [s]", "displacement [mm]", "force [kN]", "current [A]"), germans
    ),
    "Excel's UTF-8 with a byte-order mark and CRLF": lambda f: write_all(
        f, names("Time (s)", "Displacement (mm)", "Force (N)", "Current (A)"), bom
    ),
    "Excel's Unicode text": lambda f: write_all(f, USUAL, unicode_text),
    "current in mA": lambda f: write_all(
        f, names("time_s", "displacement_mm", "force_N", "current_mA")
    ),
    "time in ms, m": lambda f: write_all(
        f, names("time_ms", "displacement_m", "force_kN"), germans
    ),
    "columns in another order among others": lambda f: write_all(f, USUAL, shuffled),
    "units in a row below, preamble": lambda f: write_all(
        f,
        lambda i: {
            k.split("_")[0]: z
            for k, z in names("time_s", "displacement_mm", "force_kN", "current_A")(i).items()
        },
        units_below,
    ),
    "columns between many blanks": lambda f: write_all(f, USUAL, rounded_blanks),
    "current only in names with x for the point": lambda f: write_all(
        f,
        names("time_s", "displacement_mm", "force_N"),
        name=lambda i: f"run_12x5mm_2Hz_{i}A".replace(".", "x") + ".csv",
    ),
}


@pytest.mark.parametrize("folder", READ, ids=lambda name: name.replace(" ", "-"))
def test_read_as_it_is(tmp_path, folder):
    READ[folder](tmp_path)
    assert_right(load_campaign(tmp_path))


def test_no_header_gets_the_one_that_is_advised(tmp_path):
    write_all(tmp_path, NO_CURRENT, lambda c: csv_text(c).split("\n", 1)[1])
    error = refused(tmp_path)
    advised = re.search(r"write headers like ([\w, ]+?), with", error.advice)
    assert advised
    header = advised[1].replace(", ", ",")
    replace_in_all(tmp_path, lambda text: f"{header}\n{text}")
    assert_right(load_campaign(tmp_path))


def test_german_names_go_into_the_manifest(tmp_path):
    write_all(tmp_path, names("Zeit [s]", "Weg [mm]", "Kraft [kN]", "Strom [A]"), bom)
    error = refused(tmp_path)
    for name in ("Zeit [s]", "Weg [mm]", "Kraft [kN]"):
        assert name in error.advice, "the file's own headers are shown"
    for line in ("[columns]", 'force = { column = "Kraft [kN]", unit = "kN" }'):
        assert line in error.advice.split("\n"), "to be pasted"
    manifest(
        tmp_path,
        '[columns]\ntime = { column = "Zeit [s]", unit = "s" }\n'
        'displacement = { column = "Weg [mm]", unit = "mm" }\n'
        'force = { column = "Kraft [kN]", unit = "kN" }\n'
        'current = { column = "Strom [A]", unit = "A" }\n',
    )
    assert_right(load_campaign(tmp_path))


def test_no_units_get_the_headers_that_are_advised(tmp_path):
    """One message a column: each is followed as it comes, and the last leaves nothing to say."""
    plain = names("time", "displacement", "force")
    write_all(tmp_path, lambda i: plain(i) | {"displacement": DISPLACEMENT * 1e3})
    for _ in range(3):
        error = refused(tmp_path)
        advised = re.search(r"for example (\w+)_(\w+),", error.advice)
        assert advised
        word, unit = advised.groups()
        replace_in_all(tmp_path, lambda text, w=word, u=unit: re.sub(rf"\b{w}\b", f"{w}_{u}", text))
    assert_right(load_campaign(tmp_path))


def test_one_foreign_column_name(tmp_path):
    write_all(tmp_path, names("time_s", "stroke_mm", "force_N"))
    error = refused(tmp_path)
    advised = re.search(r"Name it like (displacement_mm),", error.advice)
    assert advised
    assert "'stroke_mm'" in error.advice
    assert 'displacement = { column = "stroke_mm", unit = "mm" }' in error.advice
    replace_in_all(tmp_path, lambda text: text.replace("stroke_mm", advised[1]))
    assert_right(load_campaign(tmp_path))


def test_decimal_commas_between_commas(tmp_path):
    write_all(tmp_path, NO_CURRENT, lambda c: csv_text(c, ";", ",").replace(";", ","))
    error = refused(tmp_path)
    assert "separate the columns by semicolon or tab" in error.advice
    write_all(tmp_path, NO_CURRENT, germans)
    assert_right(load_campaign(tmp_path))


def test_a_unit_that_is_not_known(tmp_path):
    write_all(
        tmp_path,
        lambda i: USUAL(i) | {"force_N": force(i) / 10.0},
        lambda c: csv_text(c).replace("force_N", "force_daN"),
    )
    error = refused(tmp_path)
    known = re.search(r"Known units of force: (.*)", error.advice)
    assert known
    assert "N" in known[1].split(", ")
    write_all(tmp_path, USUAL)
    assert_right(load_campaign(tmp_path))


def test_gaps_are_removed_as_advised_and_nothing_is_filled_in(tmp_path):
    write_all(tmp_path, USUAL)
    gone = slice(120, 125)
    path = tmp_path / "12.5mm_2Hz_0.5A.csv"
    lines = path.read_text().split("\n")
    for row in range(gone.start, gone.stop):
        cells = lines[1 + row].split(",")
        lines[1 + row] = ",".join((*cells[:2], "", *cells[3:]))
    path.write_text("\n".join(lines))
    error = refused(tmp_path)
    assert "line 122, column 'force_N'" in error.where
    assert "(as in 5 rows)" in error.what
    assert "remove the row" in error.advice
    path.write_text("\n".join(line for line in lines if ",," not in line))
    record = load_campaign(tmp_path).records[-1]
    left = np.delete(np.arange(ROWS), gone)
    np.testing.assert_allclose(record.time, TIME[left], atol=1e-9)
    np.testing.assert_allclose(record.force, force(0.5)[left], atol=1e-6)


def test_current_that_stands_nowhere(tmp_path):
    write_all(tmp_path, NO_CURRENT, name=lambda i: f"run {CURRENTS.index(i) + 1}.csv")
    campaign = load_campaign(tmp_path)
    with pytest.raises(SysidError) as caught:
        loop_problem(inspect(campaign).cut.loops)
    assert "in tests.csv" in str(caught.value.advice)
    rows = [f"run {n}.csv,{ampere}" for n, ampere in enumerate(CURRENTS, start=1)]
    write(tmp_path, "tests.csv", "\n".join(["file,current_A", *rows]))
    assert_right(load_campaign(tmp_path))


TURNED: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {"force": {"force_N": -1.0}, "displacement": {"displacement_mm": -1.0}}
)


@pytest.mark.parametrize("channel", TURNED)
def test_extension_positive_in_one_channel_is_told_and_mended_by_the_manifest(tmp_path, channel):
    factors = TURNED[channel]
    write_all(tmp_path, lambda i: {k: z * factors.get(k, 1.0) for k, z in USUAL(i).items()})
    told = inspect(load_campaign(tmp_path)).untrusted
    assert any("state the signs in the manifest" in sentence for sentence in told)
    manifest(tmp_path, f'[campaign]\npositive_{channel} = "extension"\n')
    campaign = load_campaign(tmp_path)
    assert inspect(campaign).trustworthy
    assert_right(campaign)


def test_flip_force_is_the_other_advice(tmp_path):
    write_all(tmp_path, lambda i: USUAL(i) | {"force_N": -force(i)})
    assert any(
        "--flip-force" in sentence for sentence in inspect(load_campaign(tmp_path)).untrusted
    )
    assert_right(load_campaign(tmp_path, flip_force=True))


def test_extension_positive_in_both_channels_is_stated(tmp_path):
    """Both turned is a damper as good as any, mirrored: only the manifest can know."""
    write_all(
        tmp_path,
        lambda i: USUAL(i) | {"force_N": -force(i), "displacement_mm": -1e3 * DISPLACEMENT},
    )
    assert inspect(load_campaign(tmp_path)).trustworthy
    manifest(
        tmp_path, '[campaign]\npositive_force = "extension"\npositive_displacement = "extension"\n'
    )
    assert_right(load_campaign(tmp_path))
