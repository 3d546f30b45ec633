"""The tier without an exact base: a physical damper in which one mechanism is raised.

Every mechanism is in that damper at its nominal level, so several names are true at once, and so
are a few things that have no switch, such as the delay of the rig's conditioners.  A name is false
if it is the cause of nothing that is at work; what is asked is whether the raised mechanism is
named.
"""

import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sysid.data.campaign import load_campaign
from sysid.data.loops import Loops
from sysid.data.quality import QualityReport, inspect
from sysid.diagnosis.result import Diagnosis
from sysid.errors import DataError, SysidError
from sysid.motion.history import RunHistory, history_of
from sysid.rig.chance import Stream
from sysid.rig.folder import write_folder
from sysid.rig.physical.mechanisms import IDLE, MECHANISMS, Mechanism, causes_at_work
from sysid.rig.trial_matrix import settings_below
from sysid.trials.outcome import Diagnose, Row
from sysid.trials.score import RIGHT, Given, Judged, Score, Verdict, family_of, given_by
from sysid.trials.trial_id import LEVEL, TrialId

if TYPE_CHECKING:
    from sysid.rig.physical.campaign import PhysicalCampaign

Unfit = Callable[[QualityReport], dict[str, str]]
"""Which tests are left out, and why: `sysid.cli.soundness.unfit`."""
TESTS: Final = 80
"""Of a campaign: always as many, so that everything is compiled once."""
PEAK_VELOCITY: Final = 0.4
"""m/s."""
RAISED: Final = tuple(m for m in MECHANISMS if m.name not in IDLE)
"""Mechanisms that take turns."""
NONE_EVERY: Final = 5
"""Every so manieth trial raises nothing."""
_STRIDE: Final = 7
_TESTS_STREAM: Final = 2_000_000


def raised_in(trial: TrialId) -> Mechanism | None:
    """What a trial raises; None where nothing."""
    if trial.effects:
        return next((m for m in MECHANISMS if m.name == trial.effects[0]), None)
    if trial.turn % NONE_EVERY == NONE_EVERY - 1:
        return None
    place = trial.turn - trial.turn // NONE_EVERY
    return RAISED[_STRIDE * place % len(RAISED)]


def run_physical(trial: TrialId, diagnose: Diagnose, unfit: Unfit) -> Row:
    """Raise, run the rig, read its files, diagnose, and only then open and score.

    The size of what was hidden is by how much raising it changes the force of the same campaign.

    Args:
        trial: Which.
        diagnose: Gets loops and their run order.
        unfit: Which tests are left out.
    """
    begin = time.perf_counter()
    raised = raised_in(trial)
    names = () if raised is None else (raised.name,)
    level = LEVEL if trial.level is None else trial.level
    levels = dict.fromkeys(names, level)
    row = Row(trial.regime, trial.seed, 0, names, (), (), 0.0)
    try:
        campaign = campaign_of(trial.seed, levels)
        loops, history = tests_of(campaign, unfit)
        nominal = tests_of(campaign_of(trial.seed, {}), unfit)[0] if names else loops
    except (SysidError, ArithmeticError) as error:  # no solution of a damper at such a level
        return replace(row, failure=f"cannot be prepared: {error}")
    prepared = time.perf_counter()
    row = replace(
        row, loops=len(loops.ids), causes=raised.causes if raised is not None and level else (),
        percents=(changed(loops, nominal),) * len(names), preparation=prepared - begin,
    )  # fmt: skip
    try:
        answer = diagnose(loops, history=history, seed=trial.seed)
    except SysidError as error:
        return replace(row, failure=f"no answer: {error}", score=score_physical((), levels))
    return replace(
        row, seconds=time.perf_counter() - prepared, score=score_physical(given_by(answer), levels),
        **_told(answer),
    )  # fmt: skip


def campaign_of(seed: int, levels: dict[str, float]) -> "PhysicalCampaign":
    """The shipped matrix of the automotive damper, less tests, at some levels."""
    from sysid.rig.physical.campaign import Asked
    from sysid.rig.scenarios.physical_matrix_165 import PHYSICAL_MATRIX_165

    every = settings_below(PEAK_VELOCITY)
    chosen = sorted(Stream(seed, _TESTS_STREAM).order(len(every)).tolist()[:TESTS])
    settings = tuple(
        Asked(every[k].amplitude, every[k].frequency, every[k].current, 40.0) for k in chosen
    )
    return replace(PHYSICAL_MATRIX_165, settings=settings, seed=seed, levels=levels)


def tests_of(campaign: "PhysicalCampaign", unfit: Unfit) -> tuple[Loops, RunHistory | None]:
    """Run a campaign, and read its files as anybody's: its loops, and what was run before each.

    Raises:
        DataError: Nothing usable came out.
    """
    from sysid.rig.physical.files import make_physical

    with tempfile.TemporaryDirectory(prefix="sysid-trial-") as place:
        folder = Path(place) / "tests"
        write_folder(make_physical(campaign), folder)
        read = load_campaign(folder)
    report = inspect(read)
    out = unfit(report)
    every = report.cut.loops
    loops = every.select(np.array([name not in out for name in every.ids], dtype=bool))
    if not loops.ids:
        raise DataError("no test of the campaign is usable")
    return loops, history_of(loops.ids, read.records, every)


def changed(loops: Loops, nominal: Loops) -> float:
    """RMS difference of the force in the tests of two campaigns, % of the second's RMS force."""
    both = [name for name in loops.ids if name in nominal.ids]
    one, other = (z.force[[z.ids.index(name) for name in both]] for z in (loops, nominal))
    return 100.0 * float(np.sqrt(np.mean((one - other) ** 2) / np.mean(other**2)))


def score_physical(given: tuple[Given, ...], levels: Mapping[str, float]) -> Score:
    """Judge an answer.

    Right is a name, a family, or a class with the test that splits it, of the raised mechanism;
    "in_family" one of something else that is at work; wrong the cause of nothing that is.

    Args:
        given: Names in the answer.
        levels: Raised mechanism → level; a level of 0 takes it out, and nothing is raised.
    """
    raised = [m for m in MECHANISMS if levels.get(m.name, 0.0) > 0.0]
    mine = tuple(cause for mechanism in raised for cause in mechanism.causes)
    judged = tuple(_judge(name, mine, causes_at_work(levels)) for name in given)
    best = min((_RANK.index(j.verdict) for j in judged if j.verdict in _RANK), default=None)
    wrong = sum(j.verdict == "wrong" for j in judged)
    missed = "wrong" if wrong else "missed"
    return Score(
        judged=judged,
        found=(missed if best is None else _RANK[best],) if raised else (),
        false_alarm=not raised and wrong > 0,
        outside_family=wrong > 0,
        spurious=wrong,
    )


_RANK: Final[tuple[Verdict, ...]] = (*RIGHT, "right_family", "vague_class")


def _judge(given: Given, mine: tuple[str, ...], every: frozenset[str]) -> Judged:
    if given.status == "family":
        families = [{family_of(cause) for cause in z} for z in (mine, every)]
        if given.family in families[0]:
            return Judged(given, "right_family", mine[0])
        return Judged(given, "in_family" if given.family in families[1] else "wrong", None)
    found = next((m for m in given.members if m in mine), None)
    if found is not None:
        of_class: Verdict = "right_class" if given.separable else "vague_class"
        return Judged(given, "right_name" if given.status == "named" else of_class, found)
    present = any(m in every for m in given.members)
    return Judged(given, "in_family" if present else "wrong", None)


def _told(answer: Diagnosis) -> dict[str, object]:
    gain = answer.gain
    return {
        "answer": answer.answer,
        "base": f"{answer.base.model} {answer.base.variant}",
        "admissible": answer.base.admissible,
        "before": 100.0 * answer.base.held_out_nrmse,
        "gain": 0.0 if gain is None else 100.0 * (gain.before - gain.after),
    }
