"""The evidence for a cause, in one sentence."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.bases import Base
from sysid.diagnosis.causes import _because, _separating, unnamed
from sysid.diagnosis.constancy import VariedSize
from sysid.diagnosis.diagnose import _notes
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.ladder import Verdict
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.quantities import free_values
from sysid.diagnosis.selection import Selection
from sysid.diagnosis.warmth import LIKE_DRIFT
from tests.data.loop_of import loops_of
from tests.diagnosis.bare import bare
from tests.diagnosis.test_ladder import STATE, contender, played

WITHOUT = replace(STATE.restricted, sizes=NONE)
"""What a fit by least squares knows of errors: nothing."""


def test_evidence_names_its_effect_and_the_next_best():
    one = played(contender("gas_spring", 300.0), contender("backlash", 40.0))
    assert _because(one) == (
        "a gas spring: score 400 where 14 would be chance; fitted it raises the log-likelihood by "
        "300, the next best (lost motion (backlash)) by 40."
    )


def test_no_more_digits_are_told_than_anybody_reads():
    """Where little is left for errors of the laws, scores go to millions."""
    one = contender("gas_spring", 123_456.0)
    told = _because(played(replace(one, scored=replace(one.scored, score=12_174_107.3))))
    assert "score 12 million where 14 would be chance" in told
    assert "log-likelihood by 120 000;" in told


@pytest.mark.parametrize("score", [12_174_107.3, 400.0, 0.0])
def test_without_a_covariance_no_score_is_held_against_chance(score):
    """Least squares know no size of errors, so that a score there is no χ²."""
    one = contender("gas_spring", 300.0)
    one = replace(one, scored=replace(one.scored, score=score))
    round_ = played(one, contender("backlash", 40.0))
    told = _because(replace(round_, before=replace(round_.before, restricted=WITHOUT)))
    assert told == (
        "a gas spring: fitted by least squares it raises the log-likelihood by 300, the next best "
        "(lost motion (backlash)) by 40."
    )


def test_a_rival_that_gained_more_is_no_next_best():
    """Far from any model tests that were left out decide, not likelihood."""
    one = played(contender("gas_spring", 17.0), contender("backlash", 18.0))
    assert _because(one).endswith(
        "the log-likelihood by 17; lost motion (backlash) by 18, with which tests left out are "
        "predicted less well."
    )


def test_a_score_of_nothing_is_not_told_as_evidence():
    """Leaks and play may pass by their fit alone."""
    leak = contender("backlash", 14.0)
    told = _because(played(replace(leak, scored=replace(leak.scored, score=0.0))))
    assert "score 0" not in told
    assert told == (
        "lost motion (backlash) shows only when it is fitted, not in the linear score: it raises "
        "the log-likelihood by 14; of the other effects of the catalogue that these tests could "
        "show none is left as a rival."
    )


@pytest.mark.parametrize(
    ("status", "refuted", "told"),
    [(None, (), True), ("named", (), False), (None, ("gas_spring",), False)],
)
def test_what_helps_and_is_no_cause_is_told_with_its_size(
    spring_state, evidence, status, refuted, told
):
    best = bare(
        Extended,
        base=bare(Base, evidence=evidence),
        selection=bare(Selection, final=spring_state, kept=("gas_spring",)),
        verdicts=(Verdict(status, ("gas_spring", "backlash"), 0.0),),
        refuted=tuple(bare(VariedSize, id=kind) for kind in refuted),
    )
    words = unnamed(best, free_values(spring_state))
    assert len(words) == told
    if told:
        assert words[0].startswith("Beside its causes the extended model has a gas spring, 0.46")
        assert "kN/m, which adds " in words[0]


@pytest.mark.parametrize(("kelvin", "doubted"), [(0.0, False), (1.3, False), (33.0, True)])
def test_errors_that_no_rig_has_are_not_put_down_to_the_rig(spring_state, kelvin, doubted):
    sizes = replace(spring_state.sizes, gain=0.006, thermometer=kelvin)
    final = replace(spring_state, restricted=replace(spring_state.restricted, sizes=sizes))
    *_, told = _notes(bare(Extended, selection=bare(Selection, final=final)))
    assert told.startswith("From test to test the force channel varies by 0.6 % in gain")
    assert (f"the thermometer by {kelvin:.2g} K" in told) == (kelvin > 0.0)
    assert ("No rig errs so much" in told) == doubted


def test_drift_is_told_from_warming_by_temperatures_not_by_replicates_alone():
    """A replicate at the end may be warmer, too."""
    loops = loops_of(np.zeros((2, 72)), np.full(2, 5e-3), np.array([1.0, 4.0]), np.zeros(2))
    either = Verdict("class", ("run_drift", *LIKE_DRIFT), 0.9)
    assert "Record the temperature" in _separating(either, loops)
    other = Verdict("class", ("run_drift", "magnetic_hysteresis"), 0.9)
    assert "Record the temperature" not in _separating(other, loops)
