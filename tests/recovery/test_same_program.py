"""Rows of a former program count only where trials that were done again came out the same."""

import json

from same_program import differences, drawn, same_as

ROW = {
    "id": "one:1", "answer": "named", "sizes": [{"value": 2e-5, "low": 1e-5}], "seconds": 9.0,
    "program": "old", "baseline": None, "misfit": 0, "after": float("nan"),
}  # fmt: skip


def test_what_belongs_to_the_run_and_rounding_are_no_difference():
    again = {**ROW, "seconds": 3.0, "program": "new", "misfit": 0.0,
             "sizes": [{"value": 2.001e-5, "low": 1e-5}]}  # fmt: skip
    assert differences(ROW, again) == []


def test_every_other_difference_is_told():
    assert differences(ROW, {**ROW, "answer": "class"}) == ["answer: 'named', now 'class'"]
    other = {**ROW, "sizes": [{"value": 2.01e-5, "low": 1e-5}]}
    assert differences(ROW, other) == ["sizes[0].value: 2e-05, now 2.01e-05"]
    assert differences(ROW, {**ROW, "sizes": []}) != []
    assert differences(ROW, {**ROW, "after": 0.5}) != []
    assert differences(ROW, {**ROW, "baseline": []}) != []
    assert differences(ROW, {k: v for k, v in ROW.items() if k != "answer"}) != []
    assert differences({"a": True}, {"a": False}) != []


def test_the_lot_is_that_of_the_program():
    names = [f"one:{k}" for k in range(100)]
    assert drawn(names, "abc", 10) == drawn(names[::-1], "abc", 10)
    assert drawn(names, "abc", 10) != drawn(names, "abd", 10)
    assert sorted(drawn(names[:3], "abc", 10)) == names[:3]


def test_programs_count_along_the_chain_and_only_backwards(tmp_path):
    file = tmp_path / "same.json"
    assert same_as("c", file) == {"c"}
    chain = [("b", "a"), ("c", "b"), ("d", "x")]
    file.write_text(json.dumps([{"program": new, "former": old} for new, old in chain]))
    assert same_as("c", file) == {"a", "b", "c"}
    assert same_as("b", file) == {"a", "b"}
    assert same_as("a", file) == {"a"}
