"""Rules by which an answer is judged once the truth is open."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from scipy.optimize import linear_sum_assignment

from sysid.diagnosis.result import Cause, Diagnosis
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS
from sysid.rig.trial_campaign import TrialTruth

Verdict = Literal[
    "right_name", "right_class", "right_family", "in_family", "vague_class", "repeated", "wrong",
]  # fmt: skip
"""Of one given name.

right_name: named, and planted.
right_class: a class that contains a planted effect, with the test that tells its members apart.
right_family: a family that a planted effect belongs to.
in_family: something outside the catalogue was planted, and this is of its declared family.
vague_class: a class that contains a planted effect, without such a test.
repeated: a planted effect that another, better answer gave already.
wrong: anything else; without a planted effect a false alarm.
"""
RIGHT: tuple[Verdict, ...] = ("right_name", "right_class")
_WORTH: dict[Verdict, int] = {
    "right_name": 9, "right_class": 7, "right_family": 2, "vague_class": 1,
}  # fmt: skip
"""What counts where names could each answer several planted effects: right answers first."""


@dataclass(frozen=True)
class Given:
    """One name (or class, or family) of an answer, whoever gave it.

    Attributes:
        status: "named", "class" or "family".
        members: Ids, the best first.
        family: Of the best member.
        confidence: That it is right.
        separable: The test that would tell the members apart is given.
    """

    status: str
    members: tuple[str, ...]
    family: str
    confidence: float
    separable: bool


@dataclass(frozen=True)
class Judged:
    """A given name and what it is worth.

    Attributes:
        given: The name.
        verdict: See `Verdict`.
        cause: The planted effect that it found; None if it found none.
    """

    given: Given
    verdict: Verdict
    cause: str | None


@dataclass(frozen=True)
class Score:
    """An answer against the truth.

    Attributes:
        judged: Every given name.
        found: Of each planted effect, the verdict on the best answer to it, "missed" if nothing
            but wrong names (or nothing) was given, "wrong" if a name stands in its place.
        false_alarm: A name was given although nothing was planted.
        outside_family: Something outside the catalogue was planted, and a name was given that is
            not of its family.
        spurious: Names beyond those that found planted effects.
    """

    judged: tuple[Judged, ...]
    found: tuple[str, ...]
    false_alarm: bool
    outside_family: bool
    spurious: int

    @property
    def all_found(self) -> bool:
        """Every planted effect was named, or its class with the separating test."""
        return all(verdict in RIGHT for verdict in self.found)


def given_by(diagnosis: Diagnosis) -> tuple[Given, ...]:
    """The names in a diagnosis."""
    return tuple(_given(cause) for cause in diagnosis.causes)


def _given(cause: Cause) -> Given:
    return Given(
        status=cause.status,
        members=cause.members or ((cause.id,) if cause.id else ()),
        family=cause.family,
        confidence=cause.confidence,
        separable=bool(cause.separating_test and cause.separating_test.strip()),
    )


def score(given: Sequence[Given], truth: TrialTruth) -> Score:
    """Judge an answer.

    Every planted effect is found by at most one given name, such that the answers are worth most
    together: the order of the names decides only among equals.

    Args:
        given: Names in the answer.
        truth: What was planted.
    """
    verdicts: list[list[Verdict | None]] = [
        [_verdict(name, cause) for cause in truth.causes] for name in given
    ]
    of_name: dict[int, str] = {}
    of_cause: dict[str, Verdict] = {}
    for k, at in _assigned(verdicts):
        verdict, cause = verdicts[k][at], truth.causes[at]
        if verdict is not None:
            of_name[k], of_cause[cause] = cause, verdict
    could = {k for k, worth in enumerate(verdicts) if any(worth)}
    judged = tuple(
        _judge(name, of_name.get(k), of_cause, k in could, truth) for k, name in enumerate(given)
    )
    wrong = sum(j.verdict == "wrong" for j in judged)
    missing = "wrong" if wrong else "missed"
    outside = bool(truth.planters) and not truth.causes
    return Score(
        judged=judged,
        found=tuple(of_cause.get(cause, missing) for cause in truth.causes),
        false_alarm=not truth.planters and bool(given),
        outside_family=outside and wrong > 0,
        spurious=sum(j.verdict in ("wrong", "repeated") for j in judged),
    )


def _assigned(verdicts: Sequence[Sequence[Verdict | None]]) -> list[tuple[int, int]]:
    """(name, planted effect), each at most once."""
    if not verdicts or not verdicts[0]:
        return []
    worth = [
        [0.0 if v is None else _WORTH[v] - 0.5 * k / len(verdicts) for v in row]
        for k, row in enumerate(verdicts)
    ]
    names, causes = linear_sum_assignment(worth, maximize=True)
    return list(zip(names.tolist(), causes.tolist(), strict=True))


def _verdict(given: Given, cause: str) -> Verdict | None:
    """What a name would be worth as an answer to one planted effect; None if nothing."""
    if given.status == "named":
        return "right_name" if given.members[:1] == (cause,) else None
    if given.status == "class":
        if cause not in given.members:
            return None
        return "right_class" if given.separable else "vague_class"
    return "right_family" if given.family == family_of(cause) else None


def _judge(
    given: Given,
    cause: str | None,
    found: dict[str, Verdict],
    could: bool,
    truth: TrialTruth,
) -> Judged:
    if cause is not None:
        return Judged(given, found[cause], cause)
    if could:
        return Judged(given, "repeated", None)
    declared = {family for family in truth.families if family is not None}
    if truth.planters and not truth.causes and given.family in declared:
        return Judged(given, "in_family", None)
    return Judged(given, "wrong", None)


def kind_of(id: str) -> type[AbstractEffect] | None:
    """The effect of an id, None where the catalogue's effect has no file."""
    return next((kind for kind in EFFECTS if kind.facts.id == id), None)


def family_of(id: str) -> str | None:
    """Family of an effect."""
    kind = kind_of(id)
    return None if kind is None else kind.facts.family
