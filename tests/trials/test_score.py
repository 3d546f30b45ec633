"""The rules: what counts as right, as wrong, as a false alarm."""

import pytest

from sysid.trials.score import given_by, score
from tests.trials.answers import a_cause, a_class, a_family, diagnosis, named, truth_of
from tests.trials.campaigns import small_trial


@pytest.mark.parametrize(
    ("given", "found", "verdict", "spurious"),
    [
        ((), "missed", None, 0),
        ((named("gas_spring"),), "right_name", "right_name", 0),
        ((named("bump_stop"),), "wrong", "wrong", 1),
        ((a_class("bump_stop", "gas_spring"),), "right_class", "right_class", 0),
        ((a_class("bump_stop", "gas_spring", separable=False),), "vague_class", "vague_class", 0),
        ((a_class("bump_stop", "fluid_inertia"),), "wrong", "wrong", 1),
        ((a_family("reactive"),), "right_family", "right_family", 0),
        ((a_family("friction"),), "wrong", "wrong", 1),
    ],
)
def test_one_name_for_one_effect(given, found, verdict, spurious):
    result = score(given, truth_of("large_gas_chamber"))
    assert result.found == (found,)
    assert [j.verdict for j in result.judged] == ([] if verdict is None else [verdict])
    assert result.spurious == spurious
    assert result.all_found == (found in ("right_name", "right_class"))
    assert not result.false_alarm


def test_a_name_in_a_class_of_one_must_be_the_effect_itself():
    """The best member decides: a true effect further down a list is no name."""
    wrong = score((named("fixture_inertia"),), truth_of("oil_column"))
    assert wrong.found == ("wrong",)
    both = score((a_class("fixture_inertia", "fluid_inertia"),), truth_of("oil_column"))
    assert both.found == ("right_class",)


@pytest.mark.parametrize("given", [named("gas_spring"), a_class("backlash", "entrained_air"),
                                   a_family("friction")])  # fmt: skip
def test_any_name_without_an_effect_is_a_false_alarm(given):
    result = score((given,), truth_of())
    assert result.false_alarm
    assert result.spurious == 1
    assert not score((), truth_of()).false_alarm


def test_two_effects():
    truth = truth_of("gas_preload", "rod_play")
    result = score((named("backlash"), named("force_offset")), truth)
    assert result.all_found
    assert result.spurious == 0
    third = score((named("backlash"), named("force_offset"), named("eddy_loss")), truth)
    assert third.all_found
    assert third.spurious == 1
    one = score((named("backlash"),), truth)
    assert one.found == ("missed", "right_name")
    assert not one.all_found


@pytest.mark.parametrize("turn", [1, -1])
def test_two_classes_that_overlap_answer_two_effects_in_any_order(turn):
    """The class that holds both answers the one that the other class lacks."""
    both = a_class("backlash", "force_offset")
    play = a_class("backlash", "entrained_air")
    result = score((both, play)[::turn], truth_of("gas_preload", "rod_play"))
    assert result.found == ("right_class", "right_class")
    assert {j.cause for j in result.judged} == {"force_offset", "backlash"}
    assert result.spurious == 0
    name = score((both, named("force_offset"))[::turn], truth_of("gas_preload", "rod_play"))
    assert set(name.found) == {"right_name", "right_class"}


def test_one_effect_is_found_once():
    """A second answer to the same effect is one too many, and the better one counts."""
    truth = truth_of("large_gas_chamber")
    result = score((a_class("bump_stop", "gas_spring"), named("gas_spring")), truth)
    assert result.found == ("right_name",)
    assert [j.verdict for j in result.judged] == ["repeated", "right_name"]
    assert result.spurious == 1


def test_a_class_answers_one_of_two_effects_only():
    truth = truth_of("large_gas_chamber", "rubber_stop")
    result = score((a_class("bump_stop", "gas_spring"),), truth)
    assert not result.all_found
    assert sorted(result.found) == ["missed", "right_class"]


def test_outside_the_catalogue_only_the_declared_family_is_right():
    truth = truth_of("check_valve")
    assert truth.causes == ()
    family = truth.families[0]
    assert family == "offset"
    inside = score((named("asymmetric_gain"),), truth)
    assert [j.verdict for j in inside.judged] == ["in_family"]
    assert not inside.outside_family
    assert not inside.false_alarm
    assert score((named("backlash"),), truth).outside_family
    assert not score((), truth).outside_family


def test_without_a_family_every_name_is_outside_it():
    assert score((named("backlash"),), truth_of("sticking_piston")).outside_family


def test_names_of_a_diagnosis():
    trial = small_trial(31)
    pair = a_cause("gas_spring", members=("gas_spring", "bump_stop"), separating_test=" ")
    given = given_by(diagnosis(trial.loops, (a_cause("backlash"), pair)))
    assert given[0].members == ("backlash",)
    assert given[0].family == "lost_motion"
    assert given[1].status == "class"
    assert not given[1].separable, "an empty sentence is no test"
