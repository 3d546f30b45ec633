"""`report.html`: whole, safe, small, and with the numbers of the result that it shows."""

import json
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sysid.diagnosis.words import percent
from sysid.report.page import render as rendering
from sysid.report.page.headline import fit_headline, floor_of
from sysid.report.page.matrix import BANDS, band_of, matrix
from sysid.report.page.one_test import OneTest, absent_tests, loop_tests, worst_of
from sysid.report.page.packed import pack, unpack
from sysid.report.page.render import embedded, render
from sysid.report.page.wording import condition, number
from tests.report.made_diagnosis import backlash, inadequate, nothing, unknown
from tests.report.made_page import (
    COMMAND,
    EVIL,
    LEFT_OUT,
    Read,
    evil_page,
    many_loops,
    many_page,
    page_of,
    summary_of,
)

LARGEST = 8_000_000


@cache
def plain() -> Read:
    return Read(render(page_of(backlash())))


def test_every_test_has_one_cell_with_the_errors_of_the_result():
    summary, read = summary_of(backlash()), plain()
    data = json.loads(read.scripts["data"])
    assert [int(c["data-test"]) for c in sorted(read.cells, key=lambda c: int(c["data-test"]))] == (
        list(range(len(backlash().loops.ids) + len(LEFT_OUT)))
    )
    stated = {t["id"]: (t["nrmse_before"], t["nrmse_after"]) for t in summary["gain"]["tests"]}
    for cell in read.cells:
        name = data["tests"][int(cell["data-test"])]["id"]
        assert name in cell["aria-label"]
        if name in LEFT_OUT:
            assert cell["data-errors"] == ""
            assert LEFT_OUT[name] in cell["aria-label"]
            continue
        assert tuple(map(float, cell["data-errors"].split())) == stated[name]
        assert f"extended model {percent(stated[name][1])}" in cell["aria-label"]


def test_numbers_of_the_diagnosis_stand_in_the_text():
    summary, read = summary_of(backlash()), plain()
    gain = summary["gain"]
    for key in ("held_out_nrmse_before", "held_out_nrmse_after", "noise_floor_nrmse"):
        assert percent(gain[key]) in read.text
    for sentence in summary["sentences"]:
        assert sentence in read.text
    for row in summary["screen"]:
        assert row["id"] in read.text
        if row["survival"] > 0.01:
            assert number(row["score"]) in read.text
    assert "not determined by these tests" not in read.text
    for told in ("a dead weight", "steps of the current", COMMAND, "0" * 64, "a note"):
        assert told in read.text
    for p in backlash().causes[0].parameters:
        assert p.name in read.text


def test_far_from_any_model_the_screen_is_not_held_against_chance():
    d = backlash()
    rows = tuple(replace(r, threshold=math.nan, se=math.nan) for r in d.screen)
    read = Read(render(page_of(replace(d, screen=rows, causes=()))))
    assert "a high score is no evidence" in read.text
    assert "not held against chance" in read.text
    assert "its threshold" not in read.text
    assert "its threshold" in plain().text


@pytest.mark.parametrize("made", [nothing, unknown, inadequate])
def test_other_answers_have_pages_too(made):
    d = made()
    summary, read = summary_of(d), Read(render(page_of(d)))
    assert summary["sentences"][0] in read.text
    assert len(read.cells) == len(d.loops.ids) + len(LEFT_OUT)
    assert all(len(c["data-errors"].split()) <= 1 for c in read.cells)


def test_the_page_needs_nothing_but_itself():
    read = plain()
    for tag, attributes in read.tags:
        assert tag not in ("link", "img", "iframe", "object", "embed", "base", "form")
        assert not {"src", "srcset", "action", "background"} & set(attributes), (tag, attributes)
        assert attributes.get("href", "#").startswith("#")
        assert not any(name.startswith("on") for name in attributes)
    assert "http" not in read.style
    assert "url(" not in read.style
    assert "import" not in read.style
    assert not re.search(r"https?://|import\s*\(|fetch\s*\(|XMLHttp", read.scripts["code"])
    policy = next(a["content"] for t, a in read.tags if t == "meta" and "http-equiv" in a)
    assert policy.startswith("default-src 'none'")


def test_figures_are_named_for_those_who_do_not_see_them():
    plots = [a for tag, a in plain().tags if tag == "div" and a.get("class", "").startswith("plot")]
    assert {p["id"] for p in plots} == {
        "worst-velocity", "worst-displacement", "damper", "detail-velocity", "detail-displacement",
        "detail-residual", "parity", "screen-chart",
    }  # fmt: skip
    assert all(p["role"] == "img" and len(p["aria-label"]) > 20 for p in plots)
    ids = [a["id"] for _, a in plain().tags if "id" in a]
    assert len(ids) == len(set(ids))


def test_a_malicious_name_is_only_a_name():
    read = Read(render(evil_page()))
    assert read.count() == plain().count()
    data = json.loads(read.scripts["data"])
    assert [t["id"] for t in data["tests"][:2]] == list(EVIL)
    for name in EVIL:
        assert name in read.text
    assert "49" not in re.findall(r"&amp;(\d+)", read.text)


def test_data_cannot_end_their_element():
    text = str(embedded({"a": "</script><!--<script>&\u2028"}))
    assert not set("<>&\u2028") & set(text)
    assert json.loads(text)["a"] == "</script><!--<script>&\u2028"
    with pytest.raises(ValueError, match="not JSON compliant"):
        embedded({"a": float("nan")})


def test_a_page_of_165_tests_is_small_and_the_same_every_time():
    page = many_page()
    first = render(page)
    assert len(first) < LARGEST
    assert first == render(page)
    assert len(Read(first).cells) == 167
    without_plotly = len(first) - len(rendering._plotly())
    assert without_plotly < 2_000_000


def test_packed_curves_come_back():
    y = 1e3 * np.sin(np.linspace(0, 6, 181)) + 5e3
    packed = pack(y)
    assert packed is not None
    assert np.abs(unpack(packed) - y).max() < 2e3 / 60_000
    assert len(packed.numbers) < 500
    flat = pack(np.full(4, 7.25))
    assert flat is not None
    assert unpack(flat) == pytest.approx(7.25)
    assert pack(np.array([1.0, np.nan])) is None
    assert pack(np.array([])) is None


def test_reading_off_takes_the_gas_away():
    """A gas force moves both peaks and leaves γ; a loop of a known shape gives its numbers."""
    loops, force = many_loops(5)
    read = []
    for gas in (0.0, 60.0):
        moved = np.where(force > 0, force, 1.2 * force) + gas
        from dataclasses import replace

        tests = loop_tests(
            replace(loops, force=moved), (moved,), dict.fromkeys(loops.ids, (0.0,)),
            dict.fromkeys(loops.ids, "fitted"),
        )  # fmt: skip
        read.append([t.measured for t in tests])
    for bare, full in zip(*read, strict=True):
        assert bare is not None
        assert full is not None
        assert full.gas - bare.gas == pytest.approx(60.0)
        assert full.compression == pytest.approx(bare.compression)
        assert full.gamma == pytest.approx(bare.gamma)
        assert bare.gamma == pytest.approx(1.2, rel=0.04)  # noise of 5 N
        assert full.energy == pytest.approx(bare.energy)
        assert full.stiffness == pytest.approx(bare.stiffness)
        assert 880.0 < bare.stiffness < 1000.0  # 900 N/m, and the gain of rebound in part


def test_matrix_groups_what_was_meant_alike():
    def test(name, a, f, i, t=40.0, **more):
        return OneTest(
            name, "fitted", amplitude=a, frequency=f, current=i, temperature=t, errors=(0.03,),
            **more,
        )  # fmt: skip

    tests = [
        test("a", 0.0101, 1.0, 0.0), test("b", 0.0099, 1.01, 0.2), test("c", 0.01, 1.0, 0.2, 60.0),
        test("d", 0.02, 1.0, float("nan")), test("e", 0.02, 2.0, -0.2, kind="triangle"),
        *absent_tests(LEFT_OUT, ()),
    ]  # fmt: skip
    found = matrix(tests, ("model",))
    assert found.columns == ("0 A", "0.2 A", "current unknown")
    assert [row.name for row in found.rows] == [
        "10 mm, 1 Hz",
        "20 mm, 1 Hz",
        "triangle",
        "other tests",
    ]
    assert [[c.id for c in group] for group in found.rows[0].cells] == [["a"], ["b", "c"], []]
    assert [c.note for c in found.rows[0].cells[1]] == ["40 °C", "60 °C"]
    assert sorted(c.place for c in found.cells) == list(range(len(tests)))
    assert [band_of(e) for e in (0.0, *BANDS, None, float("nan"))] == [0, 1, 2, 3, 4, 5, -1, -1]


def test_a_static_force_beside_the_model_is_told():
    summary = {
        "model": "lumped", "variant": "paper", "message": "It converged.",
        "summary": {"mean_nrmse": 0.077, "held_out_mean_nrmse": None},
        "static_force": {"mean_N": 66.2, "mean_nrmse_without": 0.0087},
    }  # fmt: skip
    tests = [OneTest("a", "fitted", errors=(0.3,), peak=100.0, noise=1.0, cycles=4)]
    found = fit_headline(summary, tests, 26, 1, ("why not",))
    assert [b.value for b in found.bars] == [0.077, 0.0087, 0.005]
    assert [found.width(b) for b in found.bars] == [100.0, 11.3, 6.49]
    assert any("66.2 N" in z and "0.87 %" in z for z in found.further)
    assert "1 parameter is not determined by these tests." in found.further
    assert "15 times" in found.gain
    assert "the worst, a, is off by 30 %" in found.sentence
    bare = fit_headline(summary | {"static_force": None}, tests, 26, 0, ())
    assert len(bare.bars) == 2
    assert len(bare.further) == 1


def test_noise_floor_is_that_of_the_mean_cycle():
    tests = [
        OneTest("a", "fitted", peak=100.0, noise=4.0, cycles=4),
        OneTest("b", "fitted", peak=100.0, noise=float("nan"), cycles=1),
    ]
    assert floor_of(tests) == pytest.approx(0.02)
    assert np.isnan(floor_of(tests[1:]))
    assert worst_of(tests) is None


def test_numbers_are_written_for_people():
    assert number(-0.0123456) == "−0.0123"
    assert number(float("nan")) == number(None) == "–"
    assert condition(0.0125, 1.5, 0.2, 40.0) == "12.5 mm, 1.5 Hz, 0.2 A, 40 °C"
    assert condition(0.0125, 1.5, -1e-6) == "12.5 mm, 1.5 Hz, 0 A"
    assert condition(float("nan"), float("nan"), float("nan")) == ""
