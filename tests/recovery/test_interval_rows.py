"""What the study of coverage keeps of a campaign, and the shares that it makes of it."""

import numpy as np
import pytest
from interval_rows import CARD, HOLDS, MISSES, OPEN, Told, say_shares, told
from outcome import Outcome

TRUTH = {"F_0": 100.0, "k_0": -2.0}


def test_a_row_keeps_which_intervals_hold_the_truth_and_how_wide_they_are():
    row = told(
        {
            "narrow": {"F_0": (99.0, 99.5, True), "k_0": (-2.2, -1.8, True)},
            "wide": {"F_0": (80.0, 120.0, True), "k_0": (-9.0, 9.0, False)},
        },
        TRUTH,
    )
    assert row["holds"] == {"narrow": MISSES + HOLDS, "wide": HOLDS + OPEN}
    assert row["half"] == pytest.approx({"narrow": 0.0025, "wide": 0.2}), "F_0 alone is common"


def test_without_a_parameter_that_all_kinds_tell_there_is_no_width():
    row = told({"one": {"F_0": (0.0, 200.0, False)}}, {"F_0": 100.0})
    assert row["half"] == {"one": None}
    assert Told([row], "one").hits == {}


@pytest.mark.parametrize(("hits", "outside"), [(93, False), (85, True), (100, False)])
def test_a_parameter_whose_intervals_are_too_narrow_is_told(hits, outside):
    rows = [
        told({"one": {"F_0": (99.0, 101.0 if k < hits else 99.9, True)}}, {"F_0": 100.0})
        for k in range(100)
    ]
    shares = Told(rows, "one")
    assert shares.pooled()[0] == hits / 100
    assert shares.half == pytest.approx(0.01)
    assert ("F_0" in shares.outside()) is outside


def test_of_the_card_a_row_keeps_where_the_truth_lies_also_where_nothing_is_identified():
    ends = {"F_0": (90.0, 130.0, True), "k_0": (-np.inf, -1.0, False)}
    row = told({CARD: ends}, TRUTH)
    assert row["place"] == [-0.5, None]
    assert row["width"] == [0.2, None]


def test_a_page_tells_intervals_that_hold_identified_or_not():
    """Of four campaigns that identify F_0 in two, the truth is inside in three of all."""
    places = ((90.0, 130.0, True), (90.0, 99.0, True), (0.0, 200.0, False), (0.0, 200.0, False))
    rows = [
        {"misfit": 0.0, "size": 0.0} | told({CARD: {"F_0": ends, "k_0": (-3.0, -1.0, True)}}, TRUTH)
        for ends in places
    ]
    page = Outcome("one", "One")
    say_shares(page, rows, {CARD: "the card's"}, 0.0)
    assert "| holds the truth | 1/2 | 4/4 |" in "\n".join(page.lines)
    assert "| identified or not | 3/4 | 4/4 |" in "\n".join(page.lines)
