"""Plans of trials, and misfit by its definition."""

from collections import Counter

import pytest

from sysid.errors import DataError
from sysid.rig.planters.registry import CATALOGUE, OUTSIDE
from sysid.trials.misfit import misfit_of, refitted_misfit
from sysid.trials.regimes import REGIMES, find_regime, plan
from tests.trials.campaigns import SMALL


def test_every_planter_has_its_turn():
    specs = plan("one", 2 * len(CATALOGUE), 100)
    assert set(Counter(spec.planters for spec in specs).values()) == {2}
    assert {spec.planters[0] for spec in specs} == {p.name for p in CATALOGUE}
    assert {spec.planters[0] for spec in plan("outside", 11, 0)} == {p.name for p in OUTSIDE}
    assert [spec.seed for spec in specs[:3]] == [100, 101, 102]


def test_a_plan_can_be_resumed():
    """A longer plan begins with the shorter one."""
    for regime in REGIMES:
        assert plan(regime.name, 9, 50)[:4] == plan(regime.name, 4, 50)


def test_pairs_are_of_two_families():
    for spec in plan("two", 40, 7):
        first, second = spec.hidden
        assert first.family != second.family
        assert spec.percents == (1.0, 1.0)


def test_sizes_and_misfits_are_those_of_the_targets():
    assert all(spec.percents == (1.0,) and spec.misfit == 0.0 for spec in plan("one", 30, 0))
    misfit = plan("one_misfit", 60, 0)
    assert all(spec.percents == (2.0,) for spec in misfit)
    shares = Counter(spec.misfit for spec in misfit)
    assert set(shares) == {2.0, 5.0}
    assert min(shares.values()) > 15
    assert all(not spec.planters for spec in plan("none_misfit", 5, 0))
    assert all(spec.design.model == "bouc_wen" for spec in plan("bouc_wen", 5, 0))


def test_unknown_regime():
    with pytest.raises(DataError, match="no regime"):
        find_regime("three")


@pytest.mark.parametrize("percent", [2.0, 5.0])
def test_misfit_is_what_the_refitted_base_leaves(percent):
    found = misfit_of(61, percent, SMALL)
    assert found.percent == pytest.approx(percent, rel=0.035)
    again = refitted_misfit(61, found.size, SMALL)
    assert again.percent == pytest.approx(found.percent)
    assert found.size > percent / 100.0, "parameters absorb part of every departure"


def test_no_misfit_leaves_nothing():
    assert misfit_of(61, 0.0, SMALL).size == 0.0
    assert refitted_misfit(61, 0.0, SMALL).percent < 0.05
