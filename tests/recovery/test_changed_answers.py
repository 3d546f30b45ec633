"""Every trial that a changed program answers otherwise is told, the worst first."""

from changed_answers import changed_answers, lines

from sysid.trials.trial_id import parse_id


def row(number, found, verdicts, **other):
    judged = [{"given": {"members": list(m)}, "verdict": v} for m, v in verdicts]
    id = f"two:{60000 + number}"
    spec = parse_id(id)
    return {
        "id": id, "regime": spec.regime, "seed": spec.seed, "planters": [], "percents": [],
        "causes": ["backlash", "eddy_loss"], "answer": "named" if judged else "unknown",
        "score": {"judged": judged, "found": list(found)}, "failure": None, **other,
    }  # fmt: skip


BOTH = [(("backlash",), "right_name"), (("eddy_loss",), "right_name")]
TWO = ("right_name", "right_name")


def test_better_worse_and_other_answers_are_told_apart():
    before = [row(k, TWO, BOTH) for k in range(4)] + [row(4, ("right_name", "missed"), BOTH[:1])]
    after = [
        row(0, TWO, BOTH[::-1]),
        row(1, ("right_name", "missed"), BOTH[:1]),
        row(2, TWO, [*BOTH, (("gas_spring",), "wrong")]),
        row(3, TWO, [BOTH[0], (("eddy_loss", "thixotropy"), "right_class")]),
        row(4, TWO, BOTH),
    ]
    changed, both = changed_answers(before, after)
    assert both == 5
    assert {c.id[-1]: c.worse for c in changed} == {"1": 1, "2": 1, "3": 0, "4": -1}
    head, *rest = lines(changed, both)
    assert "4 with another answer, 2 of them worse and 1 better" in head
    assert [line[:2] for line in rest] == ["+1", "+1", "+0", "-1"]


def test_of_several_rows_of_a_trial_the_last_counts():
    missed = row(0, ("right_name", "missed"), BOTH[:1])
    assert changed_answers([row(0, TWO, BOTH)], [missed, row(0, TWO, BOTH)]) == ([], 1)


def test_a_family_alone_is_less_than_a_name():
    changed, _ = changed_answers(
        [row(0, TWO, BOTH)], [row(0, ("right_name", "right_family"), BOTH[:1])]
    )
    assert changed[0].worse == 1


def test_trials_of_one_program_alone_and_failed_ones_do_not_count():
    assert changed_answers([row(0, TWO, BOTH)], [row(1, TWO, BOTH)]) == ([], 0)
    failed = row(0, (), (), failure="out of memory")
    assert changed_answers([row(0, TWO, BOTH)], [failed]) == ([], 0)
    assert changed_answers([failed], [row(0, TWO, BOTH)]) == ([], 0)
