"""The page of poor campaigns counts all of them, also those whose second diagnosis failed."""

from typing import Any

from poor_campaigns import make_page

ROW: dict[str, Any] = {
    "poverty": "one_current", "cause": "gas_spring", "bound": 1.0, "detectable": True,
    "before": "right_class", "members": ["gas_spring", "bump_stop"], "tests": ["25 mm at 2 Hz"],
    "hopeless": False, "promised": True, "after": {"right": True}, "by_chance": {"right": False},
    "failure": None,
}  # fmt: skip
NOT_RUN = ROW | {"after": None, "by_chance": None}
FAILED = NOT_RUN | {"members": [], "tests": [], "promised": False, "failure": "crashed somewhere"}


def shares(*rows: dict[str, Any]) -> dict[str, str]:
    """First words of the page's lines of tables → the next column."""
    cells = [line.strip("| ").split(" | ") for line in make_page(rows).lines if " | " in line]
    return {first: second for first, second, *_ in cells}


def test_tests_that_the_rig_cannot_run_were_recommended_nevertheless():
    hopeless = NOT_RUN | {"tests": [], "hopeless": True, "promised": False}
    told = shares(ROW, NOT_RUN, hopeless)
    assert told["recommended tests"].startswith("1/3 ")
    assert told["of these where there is one to recommend"].startswith("1/2 ")


def test_a_second_diagnosis_that_failed_settles_nothing_and_counts():
    told = shares(ROW, FAILED)
    assert told["right_class"] == "2"
    assert told["recommended tests"].startswith("1/2 ")
    assert told["of these where there is one to recommend"].startswith("1/2 ")
    assert told["nothing: it failed"].startswith("0/1 ")
    assert make_page([ROW, FAILED]).numbers["left_open"] == 2


def test_a_first_diagnosis_that_failed_left_nothing_open():
    numbers = make_page([ROW, FAILED | {"before": ""}]).numbers
    assert (numbers["seen"], numbers["left_open"]) == (1, 1)
