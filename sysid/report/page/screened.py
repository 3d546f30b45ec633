"""The screen: each effect of the catalogue alone against what the base model leaves."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from sysid.diagnosis.scores import INVISIBLE
from sysid.diagnosis.words import EFFECT_WORDS
from sysid.effects.registry import effect_kind
from sysid.parameters import specs
from sysid.report.page.wording import number, share

CHARTED: Final = 12
"""Effects in the chart; the table has all."""


@dataclass(frozen=True)
class Screened:
    """One effect.

    Attributes:
        id: Of the catalogue.
        words: Its name.
        score: χ².
        threshold: What a score must exceed; None where nobody knows.
        survival: Share of its signature that the base cannot absorb.
        verdict: "asserted", "above", "below", "unjudged" or "invisible".
        texts: Score, threshold, survival, expected size and its standard error, SI.
    """

    id: str
    words: str
    score: float | None
    threshold: float | None
    survival: float | None
    verdict: str
    texts: tuple[str, ...]


def screened(summary: dict[str, Any]) -> tuple[Screened, ...]:
    """The screen of a diagnosis, as diagnosis.json has it."""
    asserted = {c["id"] for c in summary["causes"] if c["id"] is not None}
    return tuple(_row(row, asserted) for row in summary["screen"])


def chart_of(rows: Sequence[Screened]) -> list[dict[str, Any]]:
    """The strongest that can be seen, for the script."""
    seen = [r for r in rows if r.verdict != "invisible" and r.score][:CHARTED]
    return [
        {"id": r.id, "score": r.score, "threshold": r.threshold, "verdict": r.verdict} for r in seen
    ]


def _row(row: dict[str, Any], asserted: set[str]) -> Screened:
    score, threshold, survival = row["score"], row["threshold"], row["survival"]
    if survival is None or survival < INVISIBLE:
        verdict = "invisible"
    elif row["id"] in asserted:
        verdict = "asserted"
    elif threshold is None:
        verdict = "unjudged"
    elif score is not None and score > threshold:
        verdict = "above"
    else:
        verdict = "below"
    change, se = row["expected_change"], row["se"]
    facts = effect_kind(row["id"]).facts
    unit = next(s.unit for s in specs(effect_kind(row["id"])) if s.symbol == facts.size)
    sizes = (f"{z} {unit}".strip() for z in (number(change), number(se, 2)))
    texts = (number(score), number(threshold), share(survival), *sizes)
    words = EFFECT_WORDS.get(row["id"], row["id"])
    return Screened(row["id"], words, score, threshold, survival, verdict, texts)
