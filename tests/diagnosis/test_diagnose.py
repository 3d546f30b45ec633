"""From loops to the answer: a spring of 1 % is named and measured, and nothing where nothing is."""

import json
from dataclasses import replace
from itertools import cycle

import jsonschema
import numpy as np
import pytest

from sysid.cards.extended import card_of_diagnosis
from sysid.cards.read import parse_card
from sysid.cards.verify import verify
from sysid.cards.write import card_text
from sysid.diagnosis.decoys import STRANGE
from sysid.diagnosis.diagnose import diagnose_loops
from sysid.diagnosis.stability import STEADY
from sysid.errors import DataError
from sysid.identification.conditions import conditions
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.report.diagnosis_json import diagnosis_json
from sysid.report.diagnosis_schema import json_schema
from tests.diagnosis.diagnosed import diagnosed


def test_the_spring_is_named(spring):
    assert spring.answer == "named"
    (cause,) = spring.causes
    assert (cause.status, cause.id, cause.members) == ("named", "gas_spring", ("gas_spring",))
    assert cause.confidence > 0.8
    assert cause.stability > 0.9
    assert spring.unknown.strange < STRANGE
    assert cause.score > next(r.threshold for r in spring.screen)
    assert spring.sentences[0].count("gas spring") == 1


@pytest.mark.parametrize(("of_family", "answer"), [(STEADY, "family"), (STEADY - 0.01, "unknown")])
def test_what_half_of_the_tests_do_not_come_to_is_not_named(
    spring_trial, monkeypatch, of_family, answer
):
    """Only its family is, if they come to that; else something is there, and nobody knows what."""
    shares = cycle([STEADY - 0.01, of_family])
    monkeypatch.setattr("sysid.diagnosis.judged.stability", lambda *_: next(shares))
    told = diagnosed(spring_trial.loops)
    assert told.answer == answer
    if answer == "unknown":
        assert told.causes == ()
        return
    (cause,) = told.causes
    assert (cause.id, cause.members, cause.stability) == (None, ("gas_spring",), STEADY - 0.01)
    assert cause.confidence < 0.8


def test_its_stiffness_is_the_planted_one(spring, spring_trial):
    (stiffness,) = spring.causes[0].parameters
    truth = spring_trial.truth
    x = spring_trial.loops.displacement
    true = float(np.sum((truth.force - truth.force_without) * x) / np.sum(x * x))
    assert stiffness.identified
    assert stiffness.low - 0.1 * true < true < stiffness.high + 0.1 * true
    assert stiffness.sd < 0.1 * true
    added = float(np.sqrt(np.mean((true * x) ** 2)))
    assert spring.causes[0].extra_error == pytest.approx(added, rel=0.1)


def test_the_gain_on_unseen_tests_is_measured(spring):
    gain = spring.gain
    assert gain is not None
    assert gain.after < 0.7 * gain.before
    assert gain.floor < gain.after
    assert 0.0 < gain.low < gain.reducible_explained < gain.high
    assert gain.before == pytest.approx(gain.per_test_before.mean())
    assert gain.held_out == spring.loops.ids
    splits = {words: (before, after) for words, before, after in gain.extrapolation}
    before, after = splits["the largest amplitudes"]
    assert after < 0.5 * before, "a spring matters most at large strokes"


def test_the_extended_damper_explains_the_loops_in_free_run(spring, spring_trial):
    def error(force):
        return np.sqrt(np.mean((force - spring_trial.truth.force) ** 2))

    assert error(spring.simulated_after) < 0.5 * error(spring.simulated_before)
    motion = loop_motion(spring.loops)
    np.testing.assert_allclose(simulate(spring.damper, motion), spring.simulated_after, rtol=1e-9)


def test_nothing_is_asserted_where_nothing_is(plain):
    assert plain.answer == "nothing"
    assert plain.causes == ()
    assert plain.gain is None
    assert not plain.unknown.present
    np.testing.assert_array_equal(plain.simulated_after, plain.simulated_before)
    assert all(row.score < row.threshold for row in plain.screen)


def test_what_cannot_be_seen_is_said_with_a_test(plain):
    told = {z.id: z for z in plain.invisible}
    assert {"load_cell_gain", "coil_lag", "run_drift"} <= set(told)
    assert "order of the tests" in told["run_drift"].because
    assert all(z.because and z.test for z in told.values())


@pytest.mark.parametrize("name", ["spring", "plain"])
def test_the_written_answer_keeps_its_schema(name, request):
    written = diagnosis_json(request.getfixturevalue(name))
    text = json.dumps(written, allow_nan=False)
    jsonschema.validate(json.loads(text), json_schema())
    assert written["answer"] == {"spring": "named", "plain": "nothing"}[name]


def test_the_card_simulates_what_was_diagnosed(spring):
    card = card_of_diagnosis(spring, (), damper="D", campaign="C")
    again = verify(parse_card(card_text(card), where="card.json"), where="card.json")
    assert isinstance(again, Damper)
    assert [e.facts.id for e in again.effects] == ["gas_spring"]
    forces = simulate(again, loop_motion(spring.loops))
    np.testing.assert_allclose(forces, spring.simulated_after, rtol=1e-9, atol=1e-9)


def test_too_few_tests_are_refused(spring_trial):
    loops = spring_trial.loops
    condition = conditions(loops)
    one = np.flatnonzero(condition == condition[0])
    many = loops.select(np.tile(one, 6)[:6])
    many = replace(many, temperature=np.full(6, 40.0))  # warmer ones can be told from colder ones
    with pytest.raises(DataError, match="6 tests are of one amplitude, frequency and temperature"):
        diagnose_loops(many)
    with pytest.raises(DataError, match="5 tests are too few"):
        diagnose_loops(spring_trial.loops.select(np.arange(5)))
