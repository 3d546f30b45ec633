"""Every format and every layout gives the numbers that were written, in SI."""

import sys

import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import loadmat, savemat
from written_files import FORMATS, RATE, csv_text, measured, tdms_bytes, write, xlsx_bytes

from sysid.data.campaign import load_campaign
from sysid.data.readers.mat5 import read_mat5
from sysid.data.timebase import TIME_CHANGE
from sysid.errors import DataError


def assert_same(record, columns, rows=slice(None)):
    np.testing.assert_allclose(record.time, columns["time_s"][rows], atol=1e-12)
    np.testing.assert_allclose(record.displacement, columns["displacement_mm"][rows] * 1e-3)
    np.testing.assert_allclose(record.force, columns["force_N"][rows])


def load(folder, glob="*.csv", extra=""):
    (folder / "campaign.toml").write_text(f'[files]\nglob = "{glob}"\n{extra}', encoding="utf-8")
    return load_campaign(folder)


@pytest.mark.parametrize(("ending", "written"), FORMATS)
def test_every_format_gives_the_same_record(tmp_path, ending, written):
    columns = measured()
    write(tmp_path, f"5mm_2Hz_0.5A{ending}", written(columns))
    (record,) = load(tmp_path, "5mm*").records
    assert_same(record, columns)
    assert record.nominal.frequency == 2.0
    assert record.source.changes == ("displacement converted from mm to m",)
    assert len(record.source.sha256) == 64


@pytest.mark.parametrize(
    ("separator", "decimal"),
    [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), (" ", ".")],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
def test_separators_decimals_and_encodings(tmp_path, separator, decimal, encoding):
    columns = {**measured(), "temperature_°C": np.full(60, 25.5)}
    text = csv_text(columns, separator, decimal).replace("\n", "\r\n")
    write(tmp_path, "a.csv", text.encode(encoding))
    (record,) = load_campaign(tmp_path).records
    assert_same(record, columns)
    assert record.temperature is not None
    np.testing.assert_allclose(record.temperature, 25.5)
    assert record.nominal.temperature == 25.5


@pytest.mark.parametrize(
    "header",
    [
        "time_s,displacement_mm,force_N",
        "Time [s],Displacement [mm],Force [N]",
        "time (s), displacement (mm), force (N)",
        '"time [s]","displacement [mm]","force [N]"',
        "time,displacement,force\ns,mm,N",
        "time,displacement,force\n[s],[mm],[N]",
        "Station Name:\tA\nData Acquisition:\tTimed\nTime,Displacement,Force\nSec,mm,N",
        "Rig 4; oil new\nOperator: A. B.\n\ntime_s,displacement_mm,force_N",
    ],
)
def test_headers_units_rows_and_preambles(tmp_path, header):
    columns = measured()
    body = csv_text(columns).split("\n", 1)[1]
    write(tmp_path, "a.csv", f"{header}\n{body}")
    (record,) = load_campaign(tmp_path).records
    assert_same(record, columns)


def test_units_become_si(tmp_path):
    columns = measured()
    inch, pound = 25.4, 4.4482216152605
    text = csv_text(
        {
            "time_ms": columns["time_s"] * 1e3,
            "displacement_in": columns["displacement_mm"] / inch,
            "force_lbf": columns["force_N"] / pound,
            "velocity (in/s)": np.full(60, 2.0),
            "current_mA": np.full(60, 250.0),
            "temperature_K": np.full(60, 300.0),
            "voltage_V": np.full(60, 3.0),
        }
    )
    write(tmp_path, "a.csv", text)
    (record,) = load_campaign(tmp_path).records
    assert_same(record, columns)
    np.testing.assert_allclose(record.velocity, 0.0508)
    np.testing.assert_allclose(record.current, 0.25)
    np.testing.assert_allclose(record.temperature, 26.85)
    assert record.nominal.current == 0.25
    assert record.nominal.voltage == 3.0
    assert "force converted from lbf to N" in record.source.changes


def test_blocks_with_a_time_of_their_own_are_tests(tmp_path):
    columns = measured()
    text = csv_text(columns)
    write(tmp_path, "daq.csv", f"Start 10:00\n{text}Stop\n\nStart 10:07\n{text}")
    one, two = load_campaign(tmp_path).records
    assert (one.id, two.id) == ("daq#1", "daq#2")
    assert_same(one, columns)
    assert_same(two, columns)


def test_blocks_with_a_preamble_and_a_units_row_each(tmp_path):
    columns = measured()
    body = csv_text(columns, "\t").split("\n", 1)[1]
    head = (
        "Data Header:\tTime:\t1.2\tSec\t2/14/2013\nData Acquisition:\tTimed\n"
        "Time\tDisplacement\tForce\nSec\tmm\tN\n"
    )
    write(tmp_path, "daq.csv", f"MTS793|MPT\n\n{head}{body}\n{head}{body}")
    one, two = load_campaign(tmp_path).records
    assert_same(one, columns)
    assert_same(two, columns)


def test_a_block_that_resumes_continues_the_record_and_says_so(tmp_path):
    columns = measured()
    later = {**columns, "time_s": columns["time_s"] + 5.0}
    text = f"{csv_text(columns)}Resumed 10:07\n{csv_text(later)}"
    write(tmp_path, "daq.csv", text)
    (record,) = load_campaign(tmp_path).records
    assert record.id == "daq"
    assert len(record.time) == 120
    assert any("resumes in line 64, 4.41 s after" in c for c in record.source.changes)
    one, two = load(tmp_path, extra='blocks = "separate"').records
    assert_same(one, columns)
    assert_same(two, later)


def test_many_tests_by_key_in_any_order_of_rows(tmp_path):
    tests = {"b 1": measured(current=0.1), "a": measured(current=0.9)}
    rows = ["test,time_s,displacement_mm,force_N"]
    for k in range(60):
        for name, columns in tests.items():
            rows.append(",".join([name, *(repr(float(c[k])) for c in columns.values())]))
    write(tmp_path, "many.csv", "\n".join(rows))
    records = load_campaign(tmp_path).records
    assert [r.id for r in records] == ["many#b 1", "many#a"]
    for record, columns in zip(records, tests.values(), strict=True):
        assert_same(record, columns)


def test_a_long_table_is_cut_where_conditions_change(tmp_path):
    parts = [(5.0, 2.0, 0.1), (5.0, 2.0, 0.5), (8.0, 2.0, 0.5), (5.0, 2.0, 0.1)]
    tables = [measured(current=a) for _, _, a in parts]
    table = {name: np.concatenate([t[name] for t in tables]) for name in tables[0]}
    for place, name in enumerate(("amplitude_mm", "frequency_Hz", "current_A")):
        table[name] = np.repeat([part[place] for part in parts], 60)
    write(tmp_path, "long.csv", csv_text(table))
    records = load_campaign(tmp_path).records
    assert [r.id for r in records] == [
        "long#5mm_2Hz_0.1A", "long#5mm_2Hz_0.5A", "long#8mm_2Hz_0.5A", "long#5mm_2Hz_0.1A_2",
    ]  # fmt: skip
    for record, columns, part in zip(records, tables, parts, strict=True):
        assert_same(record, columns)
        nominal = record.nominal
        assert (nominal.amplitude, nominal.frequency, nominal.current) == pytest.approx(
            (part[0] * 1e-3, part[1], part[2])
        )


def test_a_current_step_within_a_test_is_not_cut(tmp_path):
    columns = {**measured(), "current_A": np.repeat([0.0, 1.0], 30)}
    write(tmp_path, "step.csv", csv_text(columns))
    (record,) = load_campaign(tmp_path).records
    assert_same(record, columns)
    assert record.nominal.current is None
    assert record.current is not None
    assert record.current[-1] == 1.0


def test_mat_struct_array_holds_many_tests(tmp_path):
    tests = [measured(current=0.1), measured(current=0.7)]
    array = np.array(
        [tuple(t.values()) for t in tests], dtype=[(name, object) for name in tests[0]]
    )
    savemat(tmp_path / "runs.mat", {"run": array, "note": "oil A"})
    records = load(tmp_path, "*.mat").records
    assert [r.id for r in records] == ["runs#run(1)", "runs#run(2)"]
    for record, columns in zip(records, tests, strict=True):
        assert_same(record, columns)


@pytest.mark.parametrize("compressed", [True, False])
def test_mat_v5_of_every_storage_reads_as_scipy_reads_it(tmp_path, compressed):
    columns = measured()
    test = {
        "time_s": columns["time_s"].astype(np.float32),
        "displacement_mm": np.arange(60, dtype=np.int16)[None, :],
        "force_N": np.arange(60, dtype=np.uint8)[:, None],
        "current_A": 0.5,
        "note": "öl A",
        "cells": np.array([1.0, "x"], dtype=object),
        "nothing": np.empty((0, 0)),
    }
    path = tmp_path / "a.mat"
    savemat(path, {"rig": {"test": test}, "flag": np.array([[True]])}, do_compression=compressed)
    (record,) = load(tmp_path, "*.mat").records
    scipys = loadmat(path, simplify_cells=True)["rig"]["test"]
    np.testing.assert_array_equal(record.time, scipys["time_s"].astype(float))
    np.testing.assert_array_equal(record.displacement, scipys["displacement_mm"] * 1e-3)
    np.testing.assert_array_equal(record.force, scipys["force_N"])
    assert record.nominal.current == 0.5
    assert read_mat5(path.read_bytes())["rig"]["test"]["note"] == "öl A"


def test_mat_v73_struct_array_and_nested_struct(tmp_path):
    tests = [measured(current=0.1), measured(current=0.7)]
    with h5py.File(tmp_path / "runs.mat", "w", userblock_size=512) as file:
        group = file.create_group("run")
        for name in tests[0]:
            references = np.empty((1, 2), dtype=h5py.ref_dtype)
            for k, columns in enumerate(tests):
                stored = file.create_dataset(f"#refs#/{name}{k}", data=columns[name].reshape(1, -1))
                references[0, k] = stored.ref
            group.create_dataset(name, data=references, dtype=h5py.ref_dtype)
    records = load(tmp_path, "*.mat").records
    assert [r.id for r in records] == ["runs#run(1)", "runs#run(2)"]
    for record, columns in zip(records, tests, strict=True):
        assert_same(record, columns)


def test_sheets_and_groups_are_tests(tmp_path):
    first, second = measured(current=0.1), measured(current=0.7)
    write(tmp_path, "book.xlsx", xlsx_bytes(first, hot=second))
    write(tmp_path, "log.tdms", tdms_bytes(first, hot=second))
    records = load(tmp_path, "*o*.*s*").records
    assert [r.id for r in records] == ["book#data", "book#hot", "log#data", "log#hot"]
    for record, columns in zip(records, (first, second, first, second), strict=True):
        assert_same(record, columns)


def test_tdms_time_from_the_waveform_and_units_from_properties(tmp_path):
    columns = measured()
    with TdmsWriter(str(tmp_path / "log.tdms")) as writer:
        writer.write_segment(
            [
                ChannelObject(
                    "data", name, columns[f"{name}_{unit}"],
                    {"wf_increment": 1 / RATE, "unit_string": unit},
                )
                for name, unit in (("displacement", "mm"), ("force", "N"))
            ]
        )  # fmt: skip
    (record,) = load(tmp_path, "*.tdms").records
    assert_same(record, columns)
    assert "time was made from the channels' wf_increment" in record.source.changes


def test_rounded_time_stamps_are_rebuilt_and_said(tmp_path):
    columns = measured(200)
    rounded = {**columns, "time_s": np.round(np.arange(200) / 400.0, 2)}
    write(tmp_path, "a.csv", csv_text(rounded))
    (record,) = load_campaign(tmp_path).records
    np.testing.assert_allclose(np.diff(record.time), 1 / 400, rtol=0.02)
    assert len(record.time) == 200
    (said,) = [c for c in record.source.changes if c.startswith(TIME_CHANGE)]
    assert "rebuilt" in said


def test_a_stamp_that_repeats_loses_its_second_row_and_it_is_said(tmp_path):
    columns = measured()
    columns["time_s"][[20, 41]] = columns["time_s"][[19, 40]]
    write(tmp_path, "a.csv", csv_text(columns))
    (record,) = load_campaign(tmp_path).records
    assert_same(record, columns, np.delete(np.arange(60), [20, 41]))
    (said,) = [c for c in record.source.changes if c.startswith(TIME_CHANGE)]
    assert "2 of 60 rows (first in line 22)" in said


def test_a_comment_that_looks_like_a_failed_formula_is_none(tmp_path):
    head, *rows = csv_text(measured()).splitlines()
    for comment in ("#Achtung!", "#Achtung!,,"):
        write(tmp_path, "a.csv", "\n".join([head, *rows[:20], comment, *rows[20:]]))
        (record,) = load(tmp_path).records
        assert_same(record, measured())
        assert "line 22 is not data and was not read: '#Achtung!" in " ".join(record.source.changes)


def test_what_is_not_read_is_said(tmp_path):
    columns = {**measured(), "pressure_bar": np.ones(60)}
    write(tmp_path, "a.csv", csv_text(columns) + "# finished\n")
    (record,) = load_campaign(tmp_path).records
    assert_same(record, columns)
    assert "column 'pressure_bar' was not read" in record.source.changes
    assert "line 62 is not data and was not read: '# finished'" in record.source.changes


@pytest.mark.parametrize("header", ["temperature_degC", "velocity_mm/s", "current_A"])
def test_a_column_that_a_test_can_do_without_may_be_empty_and_it_is_said(tmp_path, header):
    """Our own force.csv has one where the temperature is not known."""
    columns = {**measured(), header: np.full(60, np.nan)}
    write(tmp_path, "10mm_2Hz_0.3A.csv", csv_text(columns))
    (record,) = load_campaign(tmp_path).records
    role = header.partition("_")[0]
    assert getattr(record, role) is None
    assert f"column {header!r} holds no number: {role} is not recorded" in record.source.changes


@pytest.mark.parametrize(
    ("ending", "written", "library"),
    [
        (e, w, lib)
        for (e, w), lib in zip(FORMATS[2:], ("h5py", "openpyxl", "nptdms", "pyarrow"), strict=True)
    ],
)
def test_an_absent_library_is_named_with_its_extra(tmp_path, monkeypatch, ending, written, library):
    write(tmp_path, f"a{ending}", written(measured()))
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(DataError, match=r'pip install "sysid\[formats\]"') as caught:
        load(tmp_path, "a*")
    assert library in str(caught.value)
    assert f"a{ending}" in str(caught.value)


def test_plain_tables_are_not_read_cell_by_cell(tmp_path, monkeypatch):
    def never(*_args, **_kwargs):
        raise AssertionError("a plain table was read cell by cell")

    monkeypatch.setattr("sysid.data.readers.text.tables_from_rows", never)
    for separator, decimal in ((",", "."), (";", ","), ("\t", "."), (" ", ".")):
        write(tmp_path, "a.csv", "preamble\n" + csv_text(measured(), separator, decimal))
        assert_same(load_campaign(tmp_path).records[0], measured())
