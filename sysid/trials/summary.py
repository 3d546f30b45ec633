"""Rates over many trials: counts by regime, confusions, confidence, sizes and gains."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.trials.outcome import Recovered, Row
from sysid.trials.score import RIGHT, Score

SURE: Final = 0.9
"""Confidence from which on nine in ten names must be right."""


@dataclass(frozen=True)
class Count:
    """So many of so many.

    Attributes:
        hits: Of them.
        trials: All.
    """

    hits: int
    trials: int


@dataclass(frozen=True)
class Rate:
    """One figure of the table.

    Attributes:
        regime: Of the trials.
        what: Was counted.
        count: How often.
        target: In words; empty where the issue has none.
    """

    regime: str
    what: str
    count: Count
    target: str = ""


Chosen = Callable[[Row], Score | None]


def ours(row: Row) -> Score | None:
    """The diagnosis' score."""
    return row.score


def baseline(row: Row) -> Score | None:
    """The baseline's score."""
    return row.baseline


def rates(rows: Sequence[Row], chosen: Chosen = ours) -> tuple[Rate, ...]:
    """Every rate that the rows allow, regime by regime.

    Args:
        rows: Finished trials.
        chosen: Whose score.
    """
    names = dict.fromkeys(row.regime for row in rows)
    by = {name: [r for r in rows if r.regime == name] for name in names}
    made = []
    for regime, some in by.items():
        made += _regime_rates(regime, some, chosen)
    made.append(_sure(rows, chosen))
    if chosen is ours:
        admissible = [r for r in rows if r.regime != "bouc_wen" and r.score is not None]
        made.append(
            Rate("all with an admissible base", "answers base inadequate",
                 _count(r.answer == "base_inadequate" for r in admissible), "≤ 5 %")
        )  # fmt: skip
    return tuple(rate for rate in made if rate.count.trials)


def _regime_rates(regime: str, rows: Sequence[Row], chosen: Chosen) -> list[Rate]:
    if regime in ("none", "none_misfit", "invisible"):
        return _quiet(regime, rows, chosen)
    if regime == "bouc_wen":
        given = _count(bool(s.judged) for s in _scores(rows, chosen))
        answered = [r for r in rows if r.score is not None] if chosen is ours else []
        adequate = _count(_other_base(r) for r in answered)
        return [
            Rate(regime, "says base inadequate or switches to an adequate base", adequate,
                 "≥ 95 %"),
            Rate(regime, "any name given", given),
        ]  # fmt: skip
    if regime == "outside":
        return [
            Rate(regime, "named outside its family",
                 _count(s.outside_family for s in _scores(rows, chosen)), "≤ 5 %"),
            Rate(regime, "any name given", _count(bool(s.judged) for s in _scores(rows, chosen))),
        ]  # fmt: skip
    if regime == "two":
        seen = [r for r in rows if r.visible]
        return [
            Rate(regime, "both found (visible)",
                 _count(s.all_found for s in _scores(seen, chosen)), "≥ 88 %"),
            Rate(regime, "spurious third",
                 _count(s.spurious > 0 for s in _scores(rows, chosen)), "≤ 10 %"),
        ]  # fmt: skip
    return _one(regime, rows, chosen)


def _quiet(regime: str, rows: Sequence[Row], chosen: Chosen) -> list[Rate]:
    target = {"none": "≤ 2 %", "none_misfit": "≤ 5 %"}.get(regime, "")
    scores = _scores(rows, chosen)
    made = [Rate(regime, "any name given", _count(bool(s.judged) for s in scores), target)]
    if regime == "invisible" and chosen is ours:
        answered = [r for r in rows if r.score is not None]
        made.append(
            Rate(regime, "listed as invisible", _count(r.listed_invisible for r in answered))
        )
    return made


def _one(regime: str, rows: Sequence[Row], chosen: Chosen) -> list[Rate]:
    """Rates of regimes that hide one effect."""
    targets = {"one": ("≥ 95 %", ""), "one_misfit": ("≥ 80 %", "≥ 92 %")}.get(regime, ("", ""))
    seen = _scores([r for r in rows if r.visible], chosen)
    hardly = _scores([r for r in rows if not r.visible], chosen)
    every = _scores(rows, chosen)
    names = [j for s in every for j in s.judged if j.given.status != "family"]
    return [
        Rate(regime, "right name or class (visible)", _count(s.all_found for s in seen),
             targets[0]),
        Rate(regime, "right name (visible)", _count(_by_name(s) for s in seen)),
        Rate(regime, "right name or class (the others)", _count(s.all_found for s in hardly)),
        Rate(regime, "right when a name is given",
             _count(j.verdict in RIGHT for j in names), targets[1]),
        Rate(regime, "family only", _count("right_family" in s.found for s in every)),
        Rate(regime, "missed", _count("missed" in s.found for s in every)),
        Rate(regime, "spurious", _count(s.spurious > 0 for s in every)),
    ]  # fmt: skip


def _by_name(score: Score) -> bool:
    return all(verdict == "right_name" for verdict in score.found)


def _other_base(row: Row) -> bool:
    switched = row.admissible and not row.base.startswith("generalized")
    return row.answer == "base_inadequate" or switched


def _sure(rows: Sequence[Row], chosen: Chosen) -> Rate:
    given = [
        j
        for s in _scores(rows, chosen)
        for j in s.judged
        if j.given.status in ("named", "class") and j.given.confidence >= SURE
    ]
    right = _count(j.verdict in RIGHT for j in given)
    return Rate("all", f"right of the names given at {SURE:g} or more", right, "≥ 90 %")


def _scores(rows: Sequence[Row], chosen: Chosen) -> list[Score]:
    return [s for s in map(chosen, rows) if s is not None]


def _count(hits: Iterable[bool]) -> Count:
    every = list(hits)
    return Count(sum(every), len(every))


def confusions(rows: Sequence[Row], chosen: Chosen = ours) -> tuple[tuple[str, str, int], ...]:
    """(hidden, given, how often), most frequent first, for trials that hide at most one effect."""
    pairs: Counter[tuple[str, str]] = Counter()
    for row in rows:
        scored = chosen(row)
        if scored is None or len(row.planters) > 1:
            continue
        hidden = row.causes[0] if row.causes else (row.planters[0] if row.planters else "nothing")
        given = [_label(j.given.status, j.given.members, j.given.family) for j in scored.judged]
        silent = row.answer if chosen is ours and row.answer else "nothing"
        for name in given or [silent]:
            pairs[hidden, name] += 1
    return tuple((hidden, name, n) for (hidden, name), n in pairs.most_common())


def _label(status: str, members: tuple[str, ...], family: str) -> str:
    if status == "family":
        return f"family {family}"
    return " / ".join(members)


@dataclass(frozen=True)
class Sizes:
    """How well sizes were recovered.

    Attributes:
        bias: Median of identified/true − 1, over parameters where they are defined.
        worst: Largest |median of identified/true − 1| of a planted effect's size.
        covered: Intervals that contain the truth, where planter and effect share a law.
        force: Median of RMS force added over RMS force planted, dimensionless.
    """

    bias: float
    worst: float
    covered: Count
    force: float


def sizes(rows: Sequence[Row]) -> Sizes | None:
    """Sizes recovered, pooled; None where none was."""
    found = [q for row in rows for q in row.recovered if q.identified and q.true != 0.0]
    force = [row.sizes for row in rows if row.sizes is not None]
    if not found:
        return None
    exact = [q for q in found if q.exact]
    by: dict[tuple[str, str], list[float]] = {}
    for q in exact:
        by.setdefault((q.id, q.symbol), []).append(q.value / q.true - 1.0)
    return Sizes(
        bias=float(np.median([q.value / q.true - 1.0 for q in exact])) if exact else float("nan"),
        worst=max((abs(float(np.median(v))) for v in by.values()), default=float("nan")),
        covered=_count(_covers(q) for q in exact),
        force=float(np.median(force)) if force else float("nan"),
    )


def _covers(q: Recovered) -> bool:
    return q.low <= q.true <= q.high


def gain_ratio(rows: Sequence[Row]) -> tuple[float, float, int] | None:
    """Achieved over oracle gain, visible effects of the catalogue: (of the sums, median, trials).

    None without any.  What the catalogue lacks is not to be named, and nothing is gained by it.
    """
    some = [
        r
        for r in rows
        if r.causes and r.visible and r.oracle_gain is not None and r.score is not None
    ]
    pairs = [(r.gain, r.oracle_gain) for r in some if r.oracle_gain and r.oracle_gain > 0.0]
    if not pairs:
        return None
    gained, possible = np.array(pairs).T
    return float(gained.sum() / possible.sum()), float(np.median(gained / possible)), len(pairs)
