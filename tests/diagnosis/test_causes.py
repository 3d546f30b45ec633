"""The evidence for a cause, in one sentence."""

from dataclasses import replace

from sysid.diagnosis.causes import _because
from tests.diagnosis.test_ladder import contender, played


def test_evidence_names_its_effect_and_the_next_best():
    one = played(contender("gas_spring", 300.0), contender("backlash", 40.0))
    assert _because(one) == (
        "a gas spring: score 400 where 14 would be chance; fitted it raises the log-likelihood by "
        "300, the next best (lost motion (backlash)) by 40."
    )


def test_a_score_of_nothing_is_not_told_as_evidence():
    """Where the base is far off, leaks and play pass by their fit alone."""
    leak = contender("backlash", 14.0)
    told = _because(played(replace(leak, scored=replace(leak.scored, score=0.0))))
    assert "score 0" not in told
    assert told == (
        "lost motion (backlash) shows only when it is fitted, not in the linear score: it raises "
        "the log-likelihood by 14; no other effect comes into question."
    )
