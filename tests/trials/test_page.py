"""What the page counts, on rows made by hand."""

from dataclasses import replace

import pytest

from sysid.rig.physical.mechanisms import MECHANISMS
from sysid.trials.curves import calibration, ideal, power
from sysid.trials.outcome import Recovered, Row
from sysid.trials.page import Result, page_of, physical_rates
from sysid.trials.physical import RAISED, raised_in, score_physical
from sysid.trials.score import score
from sysid.trials.trial_id import FIRST_SEED, parse_id
from sysid.trials.visible import Visibility
from tests.trials.answers import a_class, a_family, named, truth_of


def row(seed, given=(), hidden="large_gas_chamber", distance=20.0, **more) -> Row:
    truth = truth_of(hidden) if hidden else truth_of()
    return Row(
        "one" if hidden else "none", seed, 60, tuple(p.name for p in truth.planters), truth.causes,
        truth.sizes, 0.0, (Visibility(distance, 0.5, "bump_stop", 0.3, 0.99),) if hidden else (),
        answer="named" if given else "nothing", score=score(given, truth), **more,
    )  # fmt: skip


def result(one: Row, name: str = "") -> Result:
    return Result(parse_id(name or f"{one.regime}:{FIRST_SEED[one.regime] + one.seed}"), one, "abc")


def test_confidence_is_compared_with_what_is_right():
    rows = [row(0, (named("gas_spring", 0.97),)), row(1, (named("bump_stop", 0.96),)),
            row(2, (named("gas_spring", 1.0),)), row(3, (a_family("reactive"),))]  # fmt: skip
    low, high = calibration(rows)
    assert (low.low, low.high, low.right.hits, low.right.trials) == (0.95, 0.99, 1, 2)
    assert low.stated == pytest.approx(0.965)
    assert (high.high, high.right.hits, high.right.trials) == (1.0, 1, 1)


def test_a_name_that_is_only_of_the_right_family_is_not_right():
    """Of an effect that the catalogue lacks: no false alarm of its family, and no right name."""
    one = row(0, (named("bump_stop", 0.96),), hidden="rubber_bush")
    assert one.score is not None
    assert [j.verdict for j in one.score.judged] == ["in_family"]
    (found,) = calibration([one])
    assert (found.right.hits, found.right.trials) == (0, 1)
    rates = {r["what"]: r["diagnosis"] for r in page_of([result(one)], 0, {}).numbers["rates"]}
    sure = rates["right of the names given at 0.9 or more"]
    assert (sure["hits"], sure["trials"]) == (0, 1)


def test_power_goes_with_distance_and_stays_below_the_best():
    found = (named("gas_spring"),)
    rows = [row(0, found), row(1, found, distance=17.0), row(2, distance=3.0), row(3, (), "")]
    weak, strong = power(rows)
    assert (weak.low, weak.found.hits, weak.found.trials) == (2.0, 0, 1)
    assert (strong.low, strong.found.hits, strong.found.trials) == (16.0, 2, 2)
    assert weak.ideal < 0.3 < 0.98 < strong.ideal
    assert ideal(Visibility(4.5, 1.0, None, 0.0, 1.0)) == pytest.approx(0.8)


def test_trials_with_other_sizes_are_counted_apart_and_have_no_target():
    rows = [result(row(0, (named("gas_spring"),))), result(row(1), "one:30001:percent=0.25")]
    page = page_of(rows, 3, {"one:30002": "every worker that tried it died"})
    made = {(r["regime"], r["what"]): r for r in page.numbers["rates"]}
    whole, small = (made[k, "right name or class (visible)"] for k in ("one", "one, percent 0.25"))
    assert (whole["diagnosis"]["hits"], whole["target"]) == (1, "≥ 95 %")
    assert (small["diagnosis"]["hits"], small["target"]) == (0, "")
    assert "3 of the plan are missing" in page.text
    assert "every worker that tried it died" in page.text
    assert page.numbers["programs"] == {"abc": 2}


def test_gain_and_sizes_have_intervals():
    values = [2.0 + 0.03 * k for k in range(10)]
    found = [Recovered("gas_spring", "k_g", 2.0, v, v - 0.1, v + 0.1, True, True) for v in values]
    rows = [
        row(k, (named("gas_spring"),), gain=0.9 + 0.01 * k, oracle_gain=1.0, sizes=1.0,
            recovered=(found[k],))
        for k in range(10)
    ]  # fmt: skip
    numbers = page_of([result(one) for one in rows], 0, {}).numbers
    gain = numbers["gain"]
    assert gain["of_sums"] == pytest.approx(0.945)
    assert gain["low"] < 0.945 < gain["high"]
    assert numbers["sizes"]["covered"]["hits"] == 4
    assert numbers["sizes_by_parameter"]["gas_spring.k_g"]["hits"] == 4


def test_an_empty_study_has_a_page():
    assert "0 trials" in page_of([], 5, {}).text


GAS = {"gas_spring": 3.0}
GAS_CAUSES = next(m.causes for m in MECHANISMS if m.name == "gas_spring")


@pytest.mark.parametrize(
    ("given", "found", "verdict"),
    [
        (named("gas_spring"), "right_name", "right_name"),
        (named("gas_polytropic"), "right_name", "right_name"),
        (a_class("bump_stop", "gas_spring"), "right_class", "right_class"),
        (a_class("bump_stop", "gas_spring", separable=False), "vague_class", "vague_class"),
        (a_family("reactive"), "right_family", "right_family"),
        (named("seal_friction"), "missed", "in_family"),
        (named("force_offset"), "missed", "in_family"),
        (named("force_delay"), "missed", "in_family"),
        (named("coil_lag"), "wrong", "wrong"),
        (named("magnetic_hysteresis"), "wrong", "wrong"),
        (named("bump_stop"), "wrong", "wrong"),
        (a_family("no such family"), "wrong", "wrong"),
    ],
)
def test_physical_answers_are_judged_by_what_is_at_work(given, found, verdict):
    result = score_physical((given,), GAS)
    assert (result.found, [j.verdict for j in result.judged]) == ((found,), [verdict])
    alone = score_physical((given,), {})
    assert alone.false_alarm == (verdict == "wrong")


def test_what_was_taken_out_is_no_longer_true():
    """Neither raised nor at work; a cause that another mechanism has is."""
    given = (named("quadratic_loss"), named("entrained_air"))
    for levels, verdicts in (
        ({"entrance_loss": 0.0}, ["wrong", "in_family"]),
        ({"entrained_air": 0.0}, ["in_family", "in_family"]),
        ({"entrance_loss": 3.0}, ["right_name", "in_family"]),
    ):
        result = score_physical(given, levels)
        assert [j.verdict for j in result.judged] == verdicts
        assert result.found == (("right_name",) if levels.get("entrance_loss") == 3.0 else ())


def test_physical_rates_are_of_names_and_of_raised_mechanisms():
    base = Row("physical", 1, 80, ("gas_spring",), GAS_CAUSES, (3.0,), 0.0)
    rows = [
        replace(base, score=score_physical((named("gas_spring"), named("bump_stop")), GAS)),
        replace(base, score=score_physical((), GAS)),
        replace(base, planters=(), causes=(), score=score_physical((named("backlash"),), {})),
        replace(base, failure="cannot be prepared"),
    ]
    false, found, family, trials = (r.count for r in physical_rates(rows))
    assert (false.hits, false.trials) == (1, 3)
    assert (found.hits, found.trials) == (1, 2)
    assert (family.hits, trials.hits, trials.trials) == (1, 1, 3)
    page = page_of([Result(parse_id(f"physical:{FIRST_SEED['physical']}"), rows[0], "p")], 0, {})
    assert page.numbers["physical"][0]["hits"] == 1


def test_mechanisms_take_turns_and_every_fifth_trial_raises_none():
    first = FIRST_SEED["physical"]
    raised = [raised_in(parse_id(f"physical:{first + k}")) for k in range(90)]
    assert [k for k, one in enumerate(raised) if one is None] == list(range(4, 90, 5))
    names = [one.name for one in raised if one is not None]
    assert {names.count(m.name) for m in RAISED} == {4}
    assert raised_in(parse_id(f"physical:{first}:effect=play")).name == "play"
    assert raised_in(parse_id(f"physical:{first}:effect=none")) is None


def test_a_trial_that_takes_a_mechanism_out_counts_as_one_that_raises_none():
    row = Row(
        "physical", 1, 80, ("play",), (), (0.0,), 0.0, score=score_physical((), {"play": 0.0})
    )
    (only,) = physical_rates([row])
    assert (only.what, only.count.trials) == ("trials with a false name", 1)
    page = page_of([Result(parse_id("physical:100000:level=0"), row, "p")], None, {})
    assert "are missing" not in page.text
