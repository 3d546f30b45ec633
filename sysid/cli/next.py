"""`sysid next`: the tests that would settle what a diagnosis left open."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sysid.cli.console import Talk
from sysid.cli.options import Json, Quiet, UnusedSeed

if TYPE_CHECKING:
    from sysid.cards.open_questions import OpenCase
    from sysid.diagnosis.questions import Question
    from sysid.planning.advice import Advice, Plan
    from sysid.planning.candidates import Candidate


def next_tests(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder that `sysid diagnose` wrote.")
    ],
    json: Json = False,
    seed: UnusedSeed = 0,
    quiet: Quiet = False,
) -> None:
    """Say which tests would settle what a diagnosis left open: three at most, with the reason.

    Tests stay within the limits of the campaign's manifest (stroke, velocity, current,
    frequency, force); what it does not say is taken from the tests that were done, and told. Of the
    force nothing is taken from them: without `force` no test is too strong, and that is told.
    """
    talk = Talk(json, quiet)

    from sysid.cards.open_questions import read_open
    from sysid.cli.compile_cache import keep_compiled
    from sysid.planning.advice import advise
    from sysid.planning.strongest import strongest

    keep_compiled(talk, many=True)
    with talk.progress(f"Reading {folder}"):
        case = read_open(folder)
    with talk.progress("Simulating tests that could be run"):
        plan = advise(case.asked, case.limits, case.temperature)
        forces = strongest(plan.tests, case.asked.questions, case.temperature)
    _tell(talk, case, plan, forces)
    talk.result(_summary(case, plan, forces))


def _tell(talk: Talk, case: "OpenCase", plan: "Plan", forces: "Mapping[Candidate, float]") -> None:
    from sysid.planning.words import (
        advice_words,
        candidate_words,
        force_words,
        none_words,
        open_words,
        told_words,
    )

    if case.asked.questions:
        for assumed in case.limits.assumed:
            talk.note(f"Assumed: {assumed}.")
        if len(case.limits.assumed) > 1:  # the lower ends alone are always assumed
            talk.note("[limits] in the manifest say otherwise of all but the lower ends.")
        if math.isinf(case.limits.force):
            talk.notes(force_words(forces))
    else:
        talk.say(none_words(case.answer))
    for number, test in enumerate(dict.fromkeys(a.test for a in plan.tests), 1):
        why = [advice_words(a, _asked(case, a)) for a in plan.tests if a.test == test]
        talk.say(f"{number}. {candidate_words(test)}: {'; and '.join(why)}.")
    for sentence in (*open_words(plan), *told_words(case.asked.told)):
        talk.say(sentence)


def _asked(case: "OpenCase", advice: "Advice") -> "Question":
    return next(q for q in case.asked.questions if q.about == advice.about)


def _summary(case: "OpenCase", plan: "Plan", forces: "Mapping[Candidate, float]") -> dict[str, Any]:
    from sysid.planning.words import advice_words, candidate_words, open_words

    def about(questions: "tuple[Question, ...]") -> list[list[str]]:
        return [list(q.about) for q in questions]

    return {
        "schema": "sysid-next-1",
        "answer": case.answer,
        "tests": [
            {
                "kind": a.test.kind,
                "amplitude_m": a.test.amplitude,
                "frequency_Hz": a.test.frequency,
                "current_A": a.test.current,
                "largest_force_N": forces[a.test],
                "about": list(a.about),
                "words": candidate_words(a.test),
                "because": advice_words(a, _asked(case, a)),
                "log10_bayes_factor": a.log_bayes,
                "phase_rad": a.phase,
                "expected": [{"ids": list(e.ids), "force_N": e.force} for e in a.expected],
                "pairs": [
                    {
                        "ids": [list(a.expected[k].ids) for k in (p.first, p.second)],
                        "log10_bayes_factor": p.log_bayes,
                    }
                    for p in a.pairs
                ],
            }
            for a in plan.tests
        ],
        "settled": about(plan.settled),
        "not_settled": about(plan.better),
        "hopeless": about(plan.hopeless),
        "waiting": about(plan.waiting),
        "told": [{"about": list(t.about), "test": t.test} for t in case.asked.told],
        "words": list(open_words(plan)),
        "assumed": list(case.limits.assumed),
    }
