"""Cards against each other on the same tests."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.special import stdtrit

from sysid.report.page.wording import interval, number, share

LEVEL: Final = 0.95


@dataclass(frozen=True)
class CardErrors:
    """Errors of one card on the tests.

    Attributes:
        name: On the page and in messages: its file.
        model: In words, with variant and effects.
        nrmse: [n] RMSE/max|F| of each test.
        seen: [n] the card was identified from this very file.
        outside: [n] the test lies outside the card's validity.
    """

    name: str
    model: str
    nrmse: np.ndarray
    seen: np.ndarray
    outside: np.ndarray


@dataclass(frozen=True)
class Difference:
    """Error of a card minus that of the best one, over conditions.

    Attributes:
        name: Of the card.
        value: Mean over conditions of the mean difference in RMSE/max|F|.
        low: Lower end of its 95 % interval.
        high: Upper end.
        tests_better: Tests in which the best card errs less.
        tests: That were compared.
    """

    name: str
    value: float
    low: float
    high: float
    tests_better: int
    tests: int

    @property
    def told_apart(self) -> bool:
        """The interval excludes no difference."""
        return bool(self.low > 0.0)


@dataclass(frozen=True)
class Comparison:
    """The cards in order.

    Attributes:
        rows: (name, model, mean error, on tests it has not seen, tests seen, tests outside).
        differences: (name, difference with interval, tests in which the best errs less).
        best: Name of the card with the smallest mean error.
        sentence: The verdict.
        caution: What makes the comparison unfair, sentences.
    """

    rows: tuple[tuple[str, ...], ...]
    differences: tuple[tuple[str, str, str], ...]
    best: str
    sentence: str
    caution: tuple[str, ...]


def mean(values: np.ndarray) -> float:
    """Mean of the finite ones of [n] numbers, NaN without any."""
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else float("nan")


def best_of(cards: Sequence[CardErrors]) -> int:
    """Place of the card with the smallest mean error.

    Of those that have an error for most tests: a card whose force runs away in a test must not gain
    by it.
    """
    known = [int(np.isfinite(c.nrmse).sum()) for c in cards]
    means = [
        mean(c.nrmse) if n == max(known) else np.inf for c, n in zip(cards, known, strict=True)
    ]
    return int(np.argmin([np.inf if np.isnan(m) else m for m in means]))


def differences(cards: Sequence[CardErrors], conditions: Sequence[int]) -> tuple[Difference, ...]:
    r"""Every other card against the best, test by test.

    Tests of one condition (amplitude and frequency, at any current) err together, so the mean
    difference of each condition counts once: with C conditions, mean ± t_{C−1} · s/√C.

    Args:
        cards: Errors of each.
        conditions: [n] number of the condition of each test.
    """
    best = cards[best_of(cards)]
    group = np.asarray(conditions)
    found = []
    for card in cards:
        if card is best:
            continue
        apart = card.nrmse - best.nrmse
        known = np.isfinite(apart)
        means = np.array([apart[known & (group == g)].mean() for g in np.unique(group[known])])
        value, half = mean(means), float("nan")
        if means.size > 1:
            spread = means.std(ddof=1) / np.sqrt(means.size)
            half = float(stdtrit(means.size - 1, 0.5 + LEVEL / 2)) * float(spread)
        better = int(np.sum(apart[known] > 0.0))
        found.append(
            Difference(card.name, value, value - half, value + half, better, int(known.sum()))
        )
    return tuple(found)


def compare(cards: Sequence[CardErrors], conditions: Sequence[int]) -> Comparison:
    """Verdict and tables."""
    best = cards[best_of(cards)]
    apart = differences(cards, conditions)
    tests = int(np.isfinite(best.nrmse).sum())
    sentence = (
        f"{best.name} ({best.model}) predicts these {tests} tests best, with a mean error of "
        f"{share(mean(best.nrmse))} of the peak force"
    )
    close = [d.name for d in apart if not d.told_apart]
    if apart and not close:
        nearest = min(apart, key=lambda d: d.value)
        sentence += (
            f"; the next, {nearest.name}, errs by {share(nearest.value)} of it more "
            f"(95 % interval {_percent_interval(nearest)})"
        )
    elif close:
        verb = "is" if len(close) == 1 else "are"
        sentence += f"; but {', '.join(close)} {verb} not told apart from it by these tests"
    return Comparison(
        rows=tuple(_row(c) for c in cards),
        differences=tuple(
            (d.name, f"{_points(d.value)} ({_percent_interval(d)})",
             f"{d.tests_better} of {d.tests}")
            for d in apart
        ),
        best=best.name,
        sentence=f"{sentence}.",
        caution=tuple(_cautions(cards)),
    )  # fmt: skip


def comparison_json(
    campaign: str,
    ids: Sequence[str],
    cards: Sequence[CardErrors],
    conditions: Sequence[int],
    left_out: Mapping[str, str],
) -> dict[str, Any]:
    """For scripts; unknown numbers are null."""
    found = compare(cards, conditions)

    def known(value: float) -> float | None:
        return float(value) if np.isfinite(value) else None

    return {
        "schema": "sysid-comparison-1",
        "campaign": campaign,
        "best": found.best,
        "sentence": found.sentence,
        "caution": list(found.caution),
        "cards": [
            {
                "card": c.name, "model": c.model, "mean_nrmse": known(mean(c.nrmse)),
                "unseen_mean_nrmse": known(mean(c.nrmse[~c.seen])), "seen": int(c.seen.sum()),
                "outside": int(c.outside.sum()),
            }
            for c in cards
        ],
        "differences": [
            {
                "card": d.name, "nrmse": known(d.value), "low": known(d.low),
                "high": known(d.high), "level": LEVEL, "best_errs_less": d.tests_better,
                "tests": d.tests,
            }
            for d in differences(cards, conditions)
        ],
        "tests": [
            {
                "id": name,
                "nrmse": {c.name: known(float(c.nrmse[k])) for c in cards},
                "seen_by": [c.name for c in cards if c.seen[k]],
                "outside_of": [c.name for c in cards if c.outside[k]],
            }
            for k, name in enumerate(ids)
        ],
        "left_out": dict(left_out),
    }  # fmt: skip


def _row(c: CardErrors) -> tuple[str, ...]:
    return (
        c.name, c.model, share(mean(c.nrmse)), share(mean(c.nrmse[~c.seen])),
        f"{int(c.seen.sum())} of {c.seen.size}", f"{int(c.outside.sum())} of {c.seen.size}",
    )  # fmt: skip


def _cautions(cards: Sequence[CardErrors]) -> list[str]:
    told = []
    some = [c for c in cards if c.seen.any()]
    if some and len({int(c.seen.sum()) for c in cards}) > 1:
        names = ", ".join(f"{c.name}: {int(c.seen.sum())}" for c in cards)
        told.append(
            f"The comparison is not even: some cards were identified from these very tests ({names}"
            f" of {cards[0].seen.size})."
        )
    elif some:
        told.append(
            "The cards were identified from these very tests: a model with more parameters looks "
            "better than it is."
        )
    some_card = np.isfinite([c.nrmse for c in cards]).any(axis=0)
    for c in cards:
        lost = int((some_card & ~np.isfinite(c.nrmse)).sum())
        if lost:
            told.append(
                f"{c.name} gives no finite force in {lost} of {int(some_card.sum())} tests that "
                "another card predicts; its mean error is that of the others, and it is not called "
                "the best."
            )
    nobody = int((~some_card).sum())
    if nobody:
        told.append(f"{nobody} of {some_card.size} tests have no error by any card.")
    far = [c.name for c in cards if c.outside.any()]
    if far:
        told.append(f"Some tests lie outside the validity of {', '.join(far)}.")
    return told


def _points(value: float) -> str:
    return f"{number(100.0 * value, 2)} % of max|F|"


def _percent_interval(d: Difference) -> str:
    return f"{interval(100.0 * d.low, 100.0 * d.high)} %"
