"""First of all: the verdict in one sentence, and how large errors are beside the noise."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np

from sysid.diagnosis.words import MODEL_WORDS, part_interval
from sysid.report.page.look import Look
from sysid.report.page.one_test import OneTest
from sysid.report.page.wording import count, number, share

Sort = Literal["before", "after", "held", "floor"]


@dataclass(frozen=True)
class Bar:
    """One number as a bar.

    Attributes:
        label: What it is.
        value: RMSE/max|F|.
        sort: Which colour and hatch it has.
        look: Of the curve that it goes with, where that is not the one of its sort.
    """

    label: str
    value: float
    sort: Sort
    look: Look | None = None

    @property
    def text(self) -> str:
        """The number."""
        return share(self.value)


@dataclass(frozen=True)
class Headline:
    """Verdict and gain.

    Attributes:
        sentence: The verdict.
        distrust: Why the result must not be trusted; empty where it may.
        further: Sentences that explain it.
        bars: Errors and noise; those that are not known are left out.
        gain: What the bars say, a sentence; empty if nothing.
    """

    sentence: str
    distrust: tuple[str, ...]
    further: tuple[str, ...]
    bars: tuple[Bar, ...]
    gain: str

    def width(self, bar: Bar) -> float:
        """Of a bar, in per cent of the longest."""
        return round(100.0 * bar.value / max(b.value for b in self.bars), 2)


def known_bars(bars: Sequence[Bar]) -> tuple[Bar, ...]:
    """Those with a number above zero."""
    return tuple(b for b in bars if math.isfinite(b.value) and b.value > 0.0)


def floor_of(tests: Sequence[OneTest]) -> float:
    """Mean over tests of the noise of the cycle mean over max|F|; NaN where it is not known."""
    known = [
        t.mean_cycle_noise / t.peak for t in tests if t.peak and math.isfinite(t.mean_cycle_noise)
    ]
    return float(np.mean(known)) if known else math.nan


def fit_headline(
    summary: dict[str, Any],
    tests: Sequence[OneTest],
    free: int,
    open_: int,
    distrust: tuple[str, ...],
) -> Headline:
    """Of a fit.

    Args:
        summary: The content of fit.json.
        tests: All tests.
        free: Number of free parameters.
        open_: How many of them the tests do not determine.
        distrust: Why the fit must not be trusted.
    """
    told = summary["summary"]
    mean, held = (_nan(told[key]) for key in ("mean_nrmse", "held_out_mean_nrmse"))
    fitted = [t for t in tests if t.role == "fitted"]
    compared = [t for t in tests if t.errors and math.isfinite(t.errors[0])]
    worst = max(compared, key=lambda t: t.errors[0], default=None)
    model = MODEL_WORDS.get(summary["model"], summary["model"])
    sentence = (
        f"The {model} ({summary['variant']}, {count(free, 'parameter')}) repeats "
        f"{count(len(fitted), 'measured test')} with a mean error of {share(mean)} of the peak "
        "force"
    )
    if math.isfinite(held):
        sentence += f", and tests that it has not seen with {share(held)}"
    if worst is not None:
        sentence += f"; the worst, {worst.id}, is off by {share(worst.errors[0])}"
    floor = floor_of([t for t in compared if t.role == "fitted"])
    static = summary.get("static_force")
    apart = _nan(static["mean_nrmse_without"]) if static else math.nan
    bars = known_bars(
        (
            Bar("tests that were fitted", mean, "after"),
            Bar("the same, static force taken off", apart, "held"),
            Bar("tests that were held out", held, "held"),
            Bar("noise of the mean cycle", floor, "floor"),
        )
    )
    gain = ""
    if math.isfinite(floor):
        gain = f"By its scatter, the mean cycle is known to {share(floor)} of the peak force"
        gain += f": the fit's error is {mean / floor:.2g} times that." if floor else "."
    further = [summary["message"]]
    if static and math.isfinite(apart):
        further.append(
            f"Each test has a static force beside the model (the gas, or the load cell's zero; "
            f"{number(static['mean_N'])} N in the mean), which is no part of it: without that the "
            f"mean error is {share(apart)}."
        )
    if open_:
        verb = "is" if open_ == 1 else "are"
        further.append(f"{count(open_, 'parameter')} {verb} not determined by these tests.")
    return Headline(f"{sentence}.", distrust, tuple(further), bars, gain)


_ANSWERS: Final = {
    "named": "a cause is named",
    "class": "a class of causes that these tests cannot tell apart",
    "family": "a family of causes",
    "unknown": "something is left that no catalogued effect explains",
    "nothing": "these tests do not contradict the model",
    "base_inadequate": "no base model describes this damper",
}


def answer_words(answer: str) -> str:
    """What an answer means."""
    return _ANSWERS.get(answer, answer)


def diagnosis_headline(summary: dict[str, Any], distrust: tuple[str, ...]) -> Headline:
    """Of a diagnosis.

    Args:
        summary: The content of diagnosis.json.
        distrust: Why it must not be trusted.
    """
    sentences = summary["sentences"] or [answer_words(summary["answer"])]
    gain = summary["gain"]
    if gain is None:
        before = _nan(summary["base"]["held_out_nrmse"])
        bars = known_bars((Bar("base model, tests it has not seen", before, "after"),))
        return Headline(
            sentences[0], distrust, tuple(sentences[1:]), bars, "Nothing was added to the model."
        )
    before, after, floor = (
        _nan(gain[key])
        for key in ("held_out_nrmse_before", "held_out_nrmse_after", "noise_floor_nrmse")
    )
    bars = known_bars(
        (
            Bar("before: base model", before, "before"),
            Bar("after: extended model", after, "after"),
            Bar("noise of the mean cycle", floor, "floor"),
        )
    )
    told = f"Error on tests left out: {share(before)} before, {share(after)} after"
    told += f", noise of the mean cycle {share(floor)}"
    part, low, high = (_nan(gain[key]) for key in ("reducible_explained", "low", "high"))
    if math.isfinite(part):
        told += f"; {share(part)} of what could be explained"
        ends = part_interval(low, high)
        told += f" ({ends})" if ends else ""
    return Headline(sentences[0], distrust, tuple(sentences[1:]), bars, f"{told}.")


def _nan(value: float | None) -> float:
    return math.nan if value is None else float(value)
