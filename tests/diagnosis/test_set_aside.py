"""A test that all others contradict is set aside, and told before the answer."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.result import Diagnosis
from sysid.diagnosis.sentences import sentences
from sysid.identification.at_odds import OddTest
from sysid.rig.trial_campaign import Trial
from tests.diagnosis.diagnosed import diagnosed


@pytest.fixture(scope="module")
def odd(spring_trial: Trial) -> str:
    """A test in the midst of the others."""
    loops = spring_trial.loops
    speed = loops.amplitude * loops.frequency
    return loops.ids[int(np.argsort(speed)[len(loops.ids) // 2])]


@pytest.fixture(scope="module")
def answer(spring_trial: Trial, odd: str) -> Diagnosis:
    """With the amplifier of that test at half its range."""
    force = spring_trial.loops.force.copy()
    force[spring_trial.loops.ids.index(odd)] *= 0.5
    return diagnosed(replace(spring_trial.loops, force=force))


def test_the_answer_is_that_of_the_others(answer: Diagnosis, spring: Diagnosis, odd: str) -> None:
    assert answer.set_aside is not None
    assert answer.set_aside.ids == (odd,)
    assert odd not in answer.loops.ids
    assert len(answer.loops.ids) == answer.set_aside.others == len(spring.loops.ids) - 1
    assert answer.answer == "named"
    assert [c.id for c in answer.causes] == [c.id for c in spring.causes] == ["gas_spring"]
    mine, whole = (d.causes[0].parameters[0] for d in (answer, spring))
    assert mine.value == pytest.approx(whole.value, abs=whole.sd)


def test_it_is_told_first(answer: Diagnosis, odd: str) -> None:
    assert answer.sentences[0].startswith(
        f"{odd} does not agree with the other 59 tests and is set aside; it looks as if its force "
        "were 0.5"
    )
    assert answer.sentences[0].endswith(". What follows is about the other 59.")
    assert answer.set_aside is not None
    assert answer.notes[0] == answer.set_aside.words[0]
    assert "misses it by" in answer.notes[0]


def test_several_are_told_by_name(answer: Diagnosis, odd: str) -> None:
    assert answer.set_aside is not None
    two = (*answer.set_aside.tests, OddTest("other", 0.4, ("its current were 0.1 A", "it were 1")))
    both = replace(answer, set_aside=replace(answer.set_aside, tests=two, others=58))
    assert sentences(both)[0].startswith(
        f"{odd} and other do not agree with the other 58 tests and are set aside; {odd} looks as if"
    )
    assert "; other looks as if its current were 0.1 A or it were 1. What" in sentences(both)[0]


def test_nothing_is_set_aside_of_sound_tests(spring: Diagnosis, plain: Diagnosis) -> None:
    assert spring.set_aside is None
    assert plain.set_aside is None
