"""Cards against each other: which is best, and whether the tests tell it."""

import numpy as np
import pytest
from scipy import stats

from sysid.report.page.comparison import CardErrors, compare, comparison_json, differences

CONDITIONS = [0, 0, 1, 1, 2, 2]
NONE = np.zeros(6, dtype=bool)
BASE = np.array([0.02, 0.03, 0.02, 0.04, 0.03, 0.02])


def card(name: str, nrmse: np.ndarray, seen: np.ndarray = NONE) -> CardErrors:
    return CardErrors(name, "a model", nrmse, seen, NONE)


def test_a_difference_counts_conditions_and_not_tests():
    more = np.array([0.01, 0.03, 0.02, 0.02, 0.03, 0.05])
    (d,) = differences((card("a", BASE + more), card("b", BASE)), CONDITIONS)
    means = [0.02, 0.02, 0.04]
    half = stats.t(2).ppf(0.975) * np.std(means, ddof=1) / np.sqrt(3)
    assert d.name == "a"
    assert d.value == pytest.approx(np.mean(means))
    assert (d.low, d.high) == pytest.approx((np.mean(means) - half, np.mean(means) + half))
    assert (d.tests_better, d.tests) == (6, 6)


def test_verdict_says_what_is_not_told_apart():
    far, near = card("far", BASE + 0.05), card("near", BASE + np.array([1, -1, 0, 1, -1, 1]) / 100)
    found = compare((far, card("best", BASE), near), CONDITIONS)
    assert found.best == "best"
    assert "near is not told apart" in found.sentence
    assert "far" not in found.sentence
    alone = compare((far, card("best", BASE)), CONDITIONS)
    assert "the next, far, errs by 5.0 % of it more" in alone.sentence


def test_tests_that_a_card_has_seen_are_told():
    seen = np.array([True, True, False, False, False, False])
    cards = (card("a", BASE, seen), card("b", BASE + 0.01))
    assert "not even" in compare(cards, CONDITIONS).caution[0]
    told = comparison_json("c", [f"t{k}" for k in range(6)], cards, CONDITIONS, {"x": "why"})
    assert told["cards"][0]["seen"] == 2
    assert told["cards"][0]["unseen_mean_nrmse"] == pytest.approx(BASE[2:].mean())
    assert told["tests"][0]["seen_by"] == ["a"]
    assert told["left_out"] == {"x": "why"}


def test_a_card_that_runs_away_is_not_the_best():
    """The tests in which it does are no gain for it, and are told."""
    lost = np.where(np.arange(6) < 4, np.nan, 0.001)
    found = compare((card("away", lost), card("b", BASE)), CONDITIONS)
    assert found.best == "b"
    assert "these 6 tests best" in found.sentence
    assert "away gives no finite force in 4 of 6 tests" in found.caution[0]
    silent = np.where(np.arange(6) < 1, np.nan, 1.0)
    both = compare((card("a", BASE * silent), card("b", 2.0 * BASE * silent)), CONDITIONS)
    assert "these 5 tests best" in both.sentence
    assert both.caution == ("1 of 6 tests have no error by any card.",)


def test_one_condition_gives_no_interval():
    told = comparison_json("c", list("abcdef"), (card("a", BASE), card("b", BASE + 1)), [0] * 6, {})
    assert told["differences"][0]["low"] is None
