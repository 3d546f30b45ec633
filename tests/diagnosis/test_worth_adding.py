"""When a further effect is a cause of its own, on rounds made by hand."""

import pytest

from sysid.diagnosis.selection import AGAIN, LEAST_GAIN, WEAK, worth_adding
from tests.diagnosis.test_ladder import contender, played


def chosen(gained, *contenders):
    found = worth_adding(played(*contenders), gained)
    return None if found is None else found.id


def test_the_first_effect_must_beat_chance():
    assert chosen({}, contender("gas_spring", 1.1 * LEAST_GAIN)) == "gas_spring"
    assert chosen({}, contender("gas_spring", 0.9 * LEAST_GAIN)) is None


@pytest.mark.parametrize(("part", "taken"), [(1.1, "force_offset"), (0.9, None)])
def test_a_further_effect_must_not_be_what_the_first_formula_misses(part, taken):
    first = 1000.0
    assert WEAK * first > LEAST_GAIN
    assert chosen({"lost_motion": first}, contender("force_offset", part * WEAK * first)) == taken


def test_a_weak_second_effect_counts_beside_a_weak_first_one():
    assert chosen({"lost_motion": 30.0}, contender("force_offset", 20.0)) == "force_offset"


def test_what_looks_like_the_first_effect_gives_way_to_another_family():
    """A stop beside a spring is more of the spring; the offset is news, though it gains less."""
    stop = contender("bump_stop", 0.9 * AGAIN * 400.0)
    offset = contender("force_offset", 60.0)
    assert chosen({"reactive": 400.0}, stop, offset) == "force_offset"
    strong = contender("bump_stop", 1.1 * AGAIN * 400.0)
    assert chosen({"reactive": 400.0}, strong, offset) == "bump_stop"
