"""Readers under fire: any bytes give a sound record or one `SysidError` that names the file.

Valid files of every format are cut, overwritten and stuffed; text is mutated on the level of its
characters; and tables of any layout come back as they were written.
"""

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from written_files import FORMATS, csv_text, measured, write

from sysid.data.campaign import Campaign, load_campaign
from sysid.errors import SysidError

BOUNDED = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
VALID = {ending: written(measured(24)) for ending, written in FORMATS}
COUNTER = itertools.count()


def loaded(folder: Path, named: str) -> Campaign | None:
    """The campaign, or None where it was refused with one message that names `named`."""
    try:
        return load_campaign(folder)
    except SysidError as error:
        message = str(error)
    assert named in message
    assert len(message) < 1500
    return None


def assert_sound_or_refused(folder: Path, name: str, content: bytes) -> None:
    """The only two outcomes that are allowed."""
    place = folder / str(next(COUNTER))
    place.mkdir()
    write(place, name, content)
    write(place, "campaign.toml", '[files]\nglob = "a*"\n')
    campaign = loaded(place, name)
    if campaign is None:
        return
    assert campaign.records
    for record in campaign.records:
        assert len(record.time) >= 2
        assert np.all(np.diff(record.time) > 0)
        for channel in ("displacement", "force", "velocity", "current", "voltage", "temperature"):
            values = getattr(record, channel)
            if values is not None:
                assert values.dtype == np.float64
                assert values.shape == record.time.shape
                assert np.isfinite(values).all()


@pytest.mark.parametrize("ending", VALID)
@BOUNDED
@given(data=st.data())
def test_damaged_files(tmp_path, ending, data):
    content = bytearray(VALID[ending])
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, max(len(content) - 1, 0)))
        kind = data.draw(st.sampled_from(("cut", "overwrite", "insert", "remove")))
        if kind == "cut":
            del content[at:]
        elif kind == "remove":
            del content[at : at + data.draw(st.integers(1, 64))]
        elif kind == "insert":
            content[at:at] = data.draw(st.binary(min_size=1, max_size=16))
        else:
            piece = data.draw(st.binary(min_size=1, max_size=8))
            content[at : at + len(piece)] = piece
    assert_sound_or_refused(tmp_path, f"a{ending}", bytes(content))


@pytest.mark.parametrize("ending", VALID)
@settings(BOUNDED, max_examples=25)
@given(head=st.booleans(), content=st.binary(max_size=600))
def test_random_bytes(tmp_path, ending, head, content):
    start = VALID[ending][:64] if head else b""
    assert_sound_or_refused(tmp_path, f"a{ending}", start + content)


@settings(BOUNDED, max_examples=150)
@given(
    data=st.data(),
    pieces=st.lists(
        st.one_of(
            st.sampled_from(
                [",", ";", "\t", "\n", '"', "#", "-", "nan", "inf", "1e999", "1_0", "time_s",
                 "force_N", "[kN]", "\x00", "\x1a", "\r", "\ufeff", "٣", "0x1f", "=1+1", "stop\n",
                 "time_s,displacement_mm,force_N\n"]
            ),
            st.text(max_size=5),
        ),
        min_size=1,
        max_size=4,
    ),
)  # fmt: skip
def test_mutated_text(tmp_path, data, pieces):
    text = VALID[".csv"].decode()
    for piece in pieces:
        at = data.draw(st.integers(0, len(text)))
        text = text[:at] + piece + text[at + data.draw(st.integers(0, 3)) :]
    encoding = data.draw(st.sampled_from(("utf-8", "utf-16", "utf-8-sig")))
    assert_sound_or_refused(tmp_path, "a.csv", text.encode(encoding, "surrogatepass"))


@settings(BOUNDED, max_examples=100)
@given(
    layout=st.sampled_from([*itertools.product(";\t", ".,"), (",", "."), (" ", ".")]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "cp1252"]),
    form=st.sampled_from(["{}_{}", "{}[{}]", "{}({})"]),
    preamble=st.lists(st.sampled_from(["# rig", "Operator: me", "", "2020-01-02"]), max_size=3),
    order=st.permutations(["time_s", "displacement_m", "force_N", "current_A"]),
    values=st.lists(
        st.tuples(*[st.floats(-1e6, 1e6, allow_subnormal=False)] * 3), min_size=2, max_size=12
    ),
)  # fmt: skip
def test_tables_of_any_layout_come_back_bit_for_bit(
    tmp_path, layout, encoding, form, preamble, order, values
):
    separator, decimal = layout
    numbers = np.array(values)
    columns = {
        "time_s": np.arange(len(values)) * 0.005,
        "displacement_m": numbers[:, 0],
        "force_N": numbers[:, 1],
        "current_A": numbers[:, 2],
    }
    headers = {name: form.format(*name.split("_")) for name in order}
    text = csv_text({headers[name]: columns[name] for name in order}, separator, decimal)
    text = "\n".join([*preamble, text])
    folder = tmp_path / str(next(COUNTER))
    folder.mkdir()
    write(folder, "a.csv", text.encode(encoding))
    (record,) = load_campaign(folder).records
    np.testing.assert_array_equal(record.time, columns["time_s"])
    np.testing.assert_array_equal(record.displacement, columns["displacement_m"])
    np.testing.assert_array_equal(record.force, columns["force_N"])
    assert record.current is not None
    np.testing.assert_array_equal(record.current, columns["current_A"])


@settings(BOUNDED, max_examples=100)
@given(
    text=st.one_of(
        st.text(max_size=80),
        st.lists(
            st.sampled_from(
                ["[files]", "[columns]", "glob = 3", 'glob = "*"', "time = {", "}", 'column = "t"',
                 "[limits]", "stroke = { value = 1e999, unit = 'mm' }", "[[files]]", "a.b.c = 1",
                 "name = '{'", "[files.glob]", "columns = 1", "files.folder = '..'"]
            ),
            max_size=6,
        ).map("\n".join),
    )
)  # fmt: skip
def test_any_manifest(tmp_path, text):
    folder = tmp_path / str(next(COUNTER))
    folder.mkdir()
    write(folder, "a.csv", VALID[".csv"])
    write(folder, "campaign.toml", text.encode("utf-8", "surrogatepass"))
    campaign = loaded(folder, str(folder))
    assert campaign is None or campaign.records


@settings(BOUNDED, max_examples=100)
@given(
    cells=st.lists(
        st.sampled_from(
            ["file", "a.csv", "a.csv#1", "current_A", "kind", "1", "-1", "", "nan", "sine",
             "run_order", "1.5", '"', ";", "..", "/", "\x00", "ü"]
        ),
        max_size=12,
    ),
    width=st.integers(1, 4),
)  # fmt: skip
def test_any_list_of_tests(tmp_path, cells, width):
    folder = tmp_path / str(next(COUNTER))
    folder.mkdir()
    write(folder, "a.csv", VALID[".csv"])
    rows = [cells[at : at + width] for at in range(0, len(cells), width)]
    write(folder, "tests.csv", "\n".join(",".join(row) for row in rows))
    campaign = loaded(folder, "tests.csv")
    assert campaign is None or len(campaign.records) == 1
