"""What these tests cannot show, what is not settled, and what to test next."""

from dataclasses import dataclass
from typing import Any

from sysid.diagnosis.result import Cause, Diagnosis
from sysid.diagnosis.words import EFFECT_WORDS, FAMILY_WORDS, amount_beside_name, listed
from sysid.report.page.wording import number, share


@dataclass(frozen=True)
class CauseRow:
    """One asserted cause.

    Attributes:
        words: Name, class or family.
        status: "named", "class" or "family".
        confidence: As text.
        parameters: (name, value with interval).
        adds: RMS of the force that it adds.
        removes: Part of the reducible error that it removes.
        because: Evidence.
        test: That would tell the members apart; empty for a name.
    """

    words: str
    status: str
    confidence: str
    parameters: tuple[tuple[str, str], ...]
    adds: str
    removes: str
    because: str
    test: str


@dataclass(frozen=True)
class OpenEnds:
    """What is open.

    Attributes:
        causes: What is asserted.
        invisible: (effect, because, test that would show it).
        left: Sentences about what remains.
        proposals: (term, coefficient, what it removes).
        next: What to do next, sentences; commands stand in `commands`.
        commands: To be typed.
    """

    causes: tuple[CauseRow, ...]
    invisible: tuple[tuple[str, str, str], ...]
    left: tuple[str, ...]
    proposals: tuple[tuple[str, str, str], ...]
    next: tuple[str, ...]
    commands: tuple[str, ...]


def open_after_fit(undetermined: tuple[str, ...], command: str) -> OpenEnds:
    """Of a fit.

    Args:
        undetermined: What the data leave open of the parameters, sentences.
        command: That would diagnose the same tests.
    """
    told = (
        "A fit does not say why it errs. The diagnosis names the effect that is missing, if these "
        "tests can show it, and says which effects they cannot show.",
    )
    return OpenEnds((), (), tuple(f"{z}." for z in undetermined), (), told, (command,))


def open_after_diagnosis(d: Diagnosis, summary: dict[str, Any], command: str) -> OpenEnds:
    """Of a diagnosis.

    Args:
        d: The diagnosis.
        summary: The content of diagnosis.json.
        command: That would choose the next tests.
    """
    tests = [c.separating_test for c in d.causes if c.separating_test]
    return OpenEnds(
        causes=tuple(_cause(c) for c in d.causes),
        invisible=tuple(
            (EFFECT_WORDS.get(z["id"], z["id"]), z["because"], z["test"])
            for z in summary["invisible"]
        ),
        left=tuple(d.unknown.because),
        proposals=tuple(
            (t.formula, f"{number(t.coefficient)} ± {number(t.sd, 2)} {t.unit}", share(t.removes))
            for t in d.unknown.proposal
        ),
        next=tuple(dict.fromkeys(tests)),
        commands=(command,) if d.open is not None else (),
    )


def _cause(c: Cause) -> CauseRow:
    if c.status == "family":
        words = f"something of the family “{FAMILY_WORDS.get(c.family, c.family)}”"
    else:
        words = listed([EFFECT_WORDS.get(m, m) for m in c.members], "or")
    return CauseRow(
        words=words,
        status=c.status,
        confidence=share(c.confidence),
        parameters=tuple((q.name, amount_beside_name(q)) for q in c.parameters),
        adds=f"{number(c.extra_error, 2)} N",
        removes=share(c.share),
        because=c.because,
        test=c.separating_test or "",
    )
