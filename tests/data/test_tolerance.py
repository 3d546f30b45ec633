"""`[tolerance]`: read from the manifest, refused with its line, and held against peak forces."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sysid.data.conformity import SIGN, Peaks, conformity, loop_peaks
from sysid.data.manifest import read_manifest
from sysid.data.tolerance import ForceBand, Tolerance
from sysid.errors import SysidError
from tests.report.made_page import many_loops

DRAWING = """
[tolerance]
units = { velocity = "mm/s", current = "mA", force = "kN" }
temperature = [18, 22]
points = [
  { velocity = 100, current = 0, compression = [0.25, 0.31], rebound = { nominal = 0.3, percent = 10 } },
  { velocity = 100, current = 400, rebound = { lowest = 1 } },
  # { velocity = 9 }, is a remark
  { velocity = 260, compression = { nominal = 0.5, percent = 2, plus_minus = 0.02 } },
]
"""  # noqa: E501


def read(folder, text):
    path = folder / "campaign.toml"
    path.write_text(text, encoding="utf-8")
    return read_manifest(path)


def test_a_drawing_in_si(tmp_path):
    found = read(tmp_path, DRAWING).tolerance.si()
    assert found is not None
    assert found.temperature == (18.0, 22.0)
    assert not found.gas_included
    first, second, third = found.bands
    assert (first.velocity, first.current) == (0.1, 0.0)
    assert first.compression == pytest.approx((250.0, 310.0))
    assert first.rebound == pytest.approx((270.0, 330.0))
    assert second.current == pytest.approx(0.4)
    assert second.rebound == (1000.0, math.inf)
    assert second.compression is None
    assert third.current is None
    assert third.compression == pytest.approx((480.0, 520.0))  # the larger of 2 % and 20 N


def test_tables_with_headings_are_the_same(tmp_path):
    text = """
[tolerance]
gas_force = "included"
[[tolerance.points]]
velocity = 0.1
rebound = [270, 330]
[[tolerance.points]]
velocity = 0.2
rebound = [330, 270]
"""
    with pytest.raises(SysidError, match=r"line 9, tolerance\.points\[2\]\.rebound: rebound ends"):
        read(tmp_path, text)
    found = read(tmp_path, text.replace("[330, 270]", "[370, 470]")).tolerance.si()
    assert found == Tolerance(
        (ForceBand(0.1, None, None, (270.0, 330.0)), ForceBand(0.2, None, None, (370.0, 470.0))),
        gas_included=True,
    )


def test_no_tolerance_is_none(tmp_path):
    assert read(tmp_path, "").tolerance.si() is None


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("velocity = 260", "velocty = 260", ("line 9", "points[3].velocty", "Did you mean 'velo")),
        ("percent = 10 }", "percnt = 10 }", ("line 6", "points[1].rebound.percnt", "plus_minus")),
        ("velocity = 260, ", "", ("line 9", "points[3].velocity' is missing")),
        ("velocity = 260", "velocity = -1", ("line 9", "must be positive")),
        ("[0.25, 0.31]", "[0.31, 0.25]", ("line 6", "compression ends at 0.25", "[lowest")),
        ("[0.25, 0.31]", "[0.25]", ("line 6", "two numbers, [lowest, highest]")),
        ("[0.25, 0.31]", "[-0.31, -0.25]", ("line 6", "below zero", "magnitudes")),
        ("[0.25, 0.31]", '["a", 1]', ("line 6", "compression.lowest", "number")),
        (", percent = 10 }", " }", ("line 6", "without `percent` or `plus_minus`")),
        ("lowest = 1", "percent = 1", ("line 7", "without a nominal force")),
        ("lowest = 1", "nominal = 1, lowest = 1", ("line 7", "give one of them")),
        (", rebound = { lowest = 1 }", "", ("line 7", "allows everything", "Give one of them")),
        ("velocity = 260", "velocity = 100, current = 0", ("line 9", "1 and 3 have the same")),
        ('"kN"', '"mm"', ("line 3", "tolerance.units.force", "'mm' is a unit of displacement")),
        ("[18, 22]", "[22, 18]", ("line 4", "tolerance.temperature", "[lowest, highest]")),
    ],
)
def test_what_cannot_be_meant_is_refused_with_its_line(tmp_path, old, new, words):
    assert old in DRAWING
    with pytest.raises(SysidError) as caught:
        read(tmp_path, DRAWING.replace(old, new, 1))
    for word in ("campaign.toml", *words):
        assert word in str(caught.value)
    assert str(caught.value).count("\n") == 0


BANDS = Tolerance(
    (
        ForceBand(0.10, 0.2, (250.0, 310.0), (270.0, 330.0)),
        ForceBand(0.20, 0.2, (350.0, 410.0), None),
        ForceBand(0.10, 0.4, None, (900.0, math.inf)),
    )
)
TEST = Peaks("a", 0.101, 0.21, 20.0, 280.0, 300.0, gas=40.0, scatter=1.0)


def verdict(tolerance=BANDS, **other):
    found = conformity(tolerance, [replace(TEST, **other)]).tests
    return (found[0].place, found[0].verdict, found[0].words) if found else None


def test_a_test_is_held_against_its_own_line():
    assert verdict() == (0, "inside", "inside")
    assert verdict(velocity=0.196) == (1, "outside", "compression 70 N below 350 N")
    assert verdict(current=0.4, rebound=950.0) == (2, "inside", "inside")
    assert verdict(velocity=0.15) is None
    assert verdict(current=0.3) is None
    assert verdict(current=float("nan")) is None
    assert verdict(current=-0.2) == (0, "inside", "inside")


def test_outside_is_said_only_beyond_the_scatter():
    assert verdict(compression=315.0) == (0, "outside", "compression 5 N above 310 N")
    assert verdict(compression=311.0) == (0, "open", "compression too near to 310 N to tell")
    assert verdict(compression=309.0) == (0, "open", "compression too near to 310 N to tell")
    assert verdict(compression=309.0, scatter=float("nan")) == (0, "inside", "inside")
    both = verdict(compression=200.0, rebound=331.0)
    assert both == (
        0, "outside", "compression 50 N below 250 N, rebound too near to 330 N to tell"
    )  # fmt: skip


def test_a_drawing_with_the_gas_force_in_it():
    included = replace(BANDS, gas_included=True)
    assert verdict(included) == (
        0, "outside", "compression 10 N above 310 N, rebound 10 N below 270 N"
    )  # fmt: skip
    assert verdict(included, compression=240.0, rebound=340.0) == (0, "inside", "inside")
    assert verdict(included, gas=float("nan")) is None


def test_a_drawing_holds_at_its_temperature():
    cold = replace(BANDS, temperature=(15.0, 25.0))
    assert verdict(cold) is not None
    assert verdict(cold, temperature=40.0) is None


def test_a_test_at_another_temperature_is_told_with_it():
    cold = replace(BANDS, temperature=(18.0, 22.0))
    alone = conformity(cold, [replace(TEST, temperature=39.0)])
    assert alone.tests == ()
    assert [(n.id, n.place, n.temperature) for n in alone.not_judged] == [("a", 0, 39.0)]
    assert alone.sentence == (
        "No test is judged: 1 test has the velocity and current of a line, at 39 °C, and the "
        "drawing holds at 18 to 22 °C only."
    )
    others = [replace(TEST, id=f"{t}", temperature=t) for t in (20.0, 39.0, 41.3)]
    beside = conformity(cold, others)
    assert beside.sentence == (
        "1 of 1 test lies within the drawing's limits; 2 more tests have a line and are not "
        "judged, at 39 to 41.3 °C and not 18 to 22 °C; 2 of the drawing's 3 lines were not tested "
        "at 18 to 22 °C."
    )
    assert beside.untested == (1, 2)
    elsewhere = conformity(cold, [replace(TEST, temperature=39.0, velocity=0.5)])
    assert elsewhere.not_judged == ()
    assert elsewhere.sentence.startswith("No test has the velocity and current of any")


def test_a_test_of_unknown_temperature_is_open_where_the_drawing_names_one():
    cold = replace(BANDS, temperature=(18.0, 22.0))
    unknown = replace(TEST, temperature=float("nan"))
    found = conformity(cold, [unknown, replace(unknown, id="b", compression=400.0)])
    assert [(j.verdict, j.words) for j in found.tests] == [
        ("open", "temperature not known; if it is 18 to 22 °C: inside"),
        ("open", "temperature not known; if it is 18 to 22 °C: compression 90 N above 310 N"),
    ]
    assert found.sentence == (
        "0 of 2 tests lie within the drawing's limits; 2 are open: the drawing holds at 18 to "
        "22 °C, and the temperature is not known; 2 of the drawing's 3 lines were not tested."
    )
    assert conformity(BANDS, [unknown]).tests[0].verdict == "inside", "it holds at any"


def test_what_came_out_in_a_sentence():
    tests = [
        TEST, replace(TEST, id="b", compression=400.0), replace(TEST, id="c", rebound=329.0),
        replace(TEST, id="d", velocity=0.5), replace(TEST, id="e", velocity=0.2, compression=390.0),
    ]  # fmt: skip
    found = conformity(BANDS, tests)
    assert [j.id for j in found.tests] == ["a", "b", "c", "e"]
    assert found.untested == (2,)
    assert found.sentence == (
        "2 of 4 tests lie within the drawing's limits, 1 lies outside, and 1 is too near to a "
        "limit to tell; 1 of the drawing's 3 lines was not tested."
    )
    assert found.of("b") is found.tests[1]
    assert found.of("d") is None
    assert found.tests[1].text == f"{SIGN['outside']} compression 90 N above 310 N"
    assert conformity(BANDS, []).sentence.startswith("No test has the velocity and current of any")


def test_peaks_of_loops_are_told_without_the_gas():
    loops, force = many_loops(5)
    bare, full = (loop_peaks(replace(loops, force=force + gas)) for gas in (0.0, 60.0))
    for k, (one, other) in enumerate(zip(bare, full, strict=True)):
        assert one.velocity == pytest.approx(np.abs(loops.velocity[k]).max(), rel=1e-3)
        assert other.gas - one.gas == pytest.approx(60.0)
        assert other.compression == pytest.approx(one.compression)
        assert other.rebound == pytest.approx(one.rebound)
        assert one.compression == pytest.approx(force[k].max() - one.gas)
        assert one.scatter == pytest.approx(11.0 / np.sqrt(5))
