"""The page's first table against the damper's drawing."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sysid.data.conformity import SIGN, conformity, loop_peaks
from sysid.data.tolerance import ForceBand, Tolerance
from sysid.report.page.damper_table import damper_table
from sysid.report.page.one_test import loop_tests
from sysid.report.page.render import render
from tests.report.made_page import Read, many_loops, many_page


def made(count=10):
    loops, force = many_loops(count)
    names = loops.ids
    return loops, loop_tests(
        loops, (force,), dict.fromkeys(names, (0.0,)), dict.fromkeys(names, "fitted")
    )


def drawing(test):
    m = test.measured
    return ForceBand(
        test.peak_velocity, test.current, (0.9 * m.compression, 1.1 * m.compression),
        (1.2 * m.rebound, np.inf),
    )  # fmt: skip


def test_the_table_says_what_the_loops_say():
    """The page judges what it read off; `sysid check` judges the loops: the same answer."""
    loops, tests = made()
    tolerance = Tolerance((drawing(tests[0]), drawing(tests[3])))
    table = damper_table(tests, "model", tolerance)
    assert table.conformity is not None
    assert table.conformity == conformity(tolerance, loop_peaks(loops))
    judged = table.of(tests[3].id)
    assert judged is not None
    assert judged.verdict == "outside"
    assert judged.words.startswith("rebound")
    assert table.of(tests[9].id) is None
    assert damper_table(tests, "model").conformity is None


def test_verdicts_stand_in_words_and_with_a_sign():
    page = many_page()
    shown = page.tests[4], page.tests[7]
    inside = replace(drawing(shown[0]), rebound=None)
    tolerance = Tolerance((inside, drawing(shown[1])))
    table = damper_table(page.tests, "model", tolerance)
    read = Read(render(replace(page, table=table)))
    assert f"{SIGN['inside']} inside" in read.text
    assert f"{SIGN['outside']} rebound" in read.text
    assert table.conformity is not None
    assert table.conformity.sentence in read.text
    data = json.loads(read.scripts["data"])
    limits = data["limits"]
    assert [z["current"] for z in limits] == ["0.4 A", "0.2 A", "0.2 A"]
    m = shown[1].measured
    assert m is not None
    assert limits[2]["low"] is None  # rebound points downwards, and has no further end
    assert limits[2]["high"] == pytest.approx(-1.2 * m.rebound, rel=1e-4)
    facts = {t["id"]: dict(t["facts"]) for t in data["tests"]}
    assert facts[shown[0].id]["against the drawing"] == "✓ inside"
    assert "against the drawing" not in facts[page.tests[2].id]
    without = Read(render(page))
    assert SIGN["outside"] not in without.text
    assert "drawing" not in without.text
