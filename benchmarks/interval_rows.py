"""A study of intervals: its run, what it keeps of a campaign, shares of intervals that hold."""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from outcome import RESULTS, Outcome
from scipy.stats import binom
from study import run_study, study_parser
from work_file import FOLDER, read_rows

from sysid.jobs.job import Ended
from sysid.jobs.rows import shortened, strict
from sysid.trials.proportions import LEVEL, bootstrap

BAND: Final = 0.999
HOLDS, MISSES, OPEN = "+", "-", "."
"""Of a parameter's interval: it has the truth inside, has it not, or is called not identified."""
Interval = tuple[float, float, bool]
MISFITS: Final = (0.0, 2.0)
"""RMS that the refitted model leaves of a perfect measurement, % of the RMS force."""
CARD: Final = "eq_11"
"""Kind of the intervals in a card."""


@dataclass(frozen=True)
class Measured:
    """Intervals of one campaign.

    Attributes:
        found: Kind → symbol → low, high, and whether the parameter is called identified.
        truth: Symbol → value.
        size: Of the laws' errors, parts of the laws.
        took: Wall time of the intervals, s.
    """

    found: dict[str, dict[str, Interval]]
    truth: dict[str, float]
    size: float
    took: float


def study(
    about: str | None,
    stem: str,
    *,
    campaigns: int,
    first_seed: int,
    work: Callable[[str], dict[str, Any]],
    program: str,
    page: Callable[[Sequence[dict[str, Any]]], Outcome],
) -> None:
    """Do what is missing of both misfits, or only make the page of what is done.

    Args:
        about: What the script does.
        stem: Of the files of rows and results.
        campaigns: Of each misfit, unless the command line says otherwise.
        first_seed: Of the campaigns.
        work: Function of a module: name of a campaign → row.
        program: Of the rows that count.
        page: Rows → page.
    """
    parser = study_parser(about or "", "one campaign of each misfit")
    parser.add_argument("--campaigns", type=int, default=campaigns, help="of each misfit")
    given = parser.parse_args()
    file = FOLDER / f"{stem}.quick.jsonl" if given.quick else RESULTS / f"{stem}.jsonl"
    seeds = range(first_seed, first_seed + (1 if given.quick else given.campaigns))
    names = [f"{misfit:g}:{seed}" for seed in seeds for misfit in MISFITS]
    if not given.page:
        run_study(names, work, file, program, processes=given.processes, words=_words)
    rows = [row for row in read_rows(file) if row["id"] in set(names)]
    if not rows:
        sys.exit(f"No campaign is finished in {file}: run this without --page")
    page(rows).finish(keep=not given.quick)


def row_of(name: str, measured: Callable[[int, float], Measured], program: str) -> dict[str, Any]:
    """The row of a campaign by its name.

    Args:
        name: Misfit and seed.
        measured: Seed, misfit in % → intervals.
        program: That makes them.
    """
    misfit, seed = name.split(":")
    m = measured(int(seed), float(misfit))
    return {"id": name, "misfit": float(misfit), **told(m.found, m.truth),
            **shortened({"size": m.size, "took": m.took}, 3), "program": program}  # fmt: skip


def _words(ended: Ended) -> str:
    """How the card's intervals did, in a few words."""
    signs = (ended.row or {})["holds"][CARD]
    return f"{signs.count(HOLDS)} of {len(signs) - signs.count(OPEN)} intervals hold the truth"


def told(found: dict[str, dict[str, Interval]], truth: dict[str, float]) -> dict[str, Any]:
    """What is kept of intervals: a sign for each parameter and kind, and how wide the kinds are.

    Args:
        found: Kind → symbol → low, high, and whether the parameter is called identified.
        truth: Symbol → value.

    Returns:
        ``symbols``; ``holds``, kind → a sign for each; ``half``, kind → median half width, parts of
        the true value, of parameters that all kinds call identified; ``place`` and ``width``: of
        each of the card's intervals, identified or not, where the truth lies, from −1 at its low
        end to 1 at its high one, and its half width in parts of the truth (null: it has no end).
    """
    common = [s for s in truth if all(ends[s][2] for ends in found.values())]

    def sign(ends: Interval, value: float) -> str:
        return OPEN if not ends[2] else HOLDS if ends[0] <= value <= ends[1] else MISSES

    def half(ends: Interval, value: float) -> float:
        return 0.5 * (ends[1] - ends[0]) / abs(value)

    return {
        "symbols": list(truth),
        "holds": {
            kind: "".join(sign(here[s], truth[s]) for s in truth) for kind, here in found.items()
        },
        "half": shortened(
            {
                kind: float(np.median([half(here[s], truth[s]) for s in common]))
                if common else None for kind, here in found.items()
            }, 3,
        ),
        **strict(shortened(_card(found.get(CARD, {}), truth), 3)),
    }  # fmt: skip


def _card(ends: Mapping[str, Interval], truth: Mapping[str, float]) -> dict[str, list[float]]:
    """Where in the card's intervals the truth lies, and how wide they are."""
    if not ends:
        return {}
    low, high, _ = np.array([ends[s] for s in truth]).T
    value, half = np.array(list(truth.values())), 0.5 * (high - low)
    with np.errstate(invalid="ignore", divide="ignore"):
        place = (value - 0.5 * (low + high)) / half
    return {"place": place.tolist(), "width": (half / np.abs(value)).tolist()}


class Told:
    """Shares of the intervals of one kind that hold the truth.

    Args:
        rows: Campaigns.
        kind: Of interval.
    """

    def __init__(self, rows: Sequence[dict[str, Any]], kind: str) -> None:
        self.hits: dict[str, list[bool]] = {}
        self.campaigns: list[tuple[int, int]] = []
        for row in rows:
            signs = row["holds"][kind]
            for symbol, sign in zip(row["symbols"], signs, strict=True):
                if sign != OPEN:
                    self.hits.setdefault(symbol, []).append(sign == HOLDS)
            self.campaigns.append((signs.count(HOLDS), len(signs) - signs.count(OPEN)))
        halves = [row["half"][kind] for row in rows if row["half"][kind] is not None]
        self.half = float(np.median(halves)) if halves else float("nan")

    def pooled(self) -> tuple[float, float, float]:
        """Share with its interval, campaigns drawn anew as wholes."""
        both = np.array(self.campaigns)
        return bootstrap(lambda k: float(both[k, 0].sum() / both[k, 1].sum()), len(both))

    def outside(self) -> dict[str, tuple[int, int]]:
        """Parameters whose own share is outside its 99.9 % binomial band: hits, trials."""
        out = {}
        for symbol, inside in self.hits.items():
            low, high = binom.interval(BAND, len(inside), LEVEL)
            if not low <= sum(inside) <= high:
                out[symbol] = (sum(inside), len(inside))
        return out


def say_shares(
    outcome: Outcome, rows: Sequence[dict[str, Any]], kinds: Mapping[str, str], misfit: float
) -> None:
    """A page's part on one misfit: shares of every kind of interval, and of the card's parameters.

    Args:
        outcome: The page, and its numbers.
        rows: Campaigns of all misfits; nothing is said where there are none of this one.
        kinds: Kind → what it is.
        misfit: %.
    """
    here = [r for r in rows if r["misfit"] == misfit]
    if not here:
        return
    table, numbers = [], {}
    for kind, words in kinds.items():
        one = Told(here, kind)
        share, low, high = one.pooled()
        outside = one.outside()
        shown = ", ".join(f"{s} {h}/{n}" for s, (h, n) in sorted(outside.items())) or "none"
        count = sum(n for _, n in one.campaigns)
        table.append((words, f"{share:.1%} ({low:.1%} to {high:.1%})", count,
                      f"± {one.half:.2%}", shown))  # fmt: skip
        numbers[kind] = {
            "share": share, "low": low, "high": high, "intervals": count, "half": one.half,
            "outside": outside,
            "by_symbol": {s: [sum(z), len(z)] for s, z in sorted(one.hits.items())},
        }  # fmt: skip
    sizes = [r["size"] for r in here]
    laws = f", laws wrong by {np.mean(sizes):.1%} (RMS)" if misfit else ", laws right"
    outcome.say(f"## The refitted model leaves {misfit:g} %{laws}: {len(here)} campaigns")
    outcome.table(
        ("interval", "holds the truth (aim 92–98 %)", "intervals", "half width",
         f"parameters outside the {BAND:.1%} binomial band of 95 %"), table,
    )  # fmt: skip
    own = numbers[CARD]["by_symbol"]
    lines = [("holds the truth", *(f"{h}/{n}" for h, n in own.values()))]
    always = _always([r for r in here if "place" in r])
    if always:
        lines.append(("identified or not", *("{}/{}".format(*always[s]) for s in own)))
        numbers[CARD]["identified_or_not"] = always
    outcome.table(("the card's, parameter", *own), lines)
    outcome.numbers[f"misfit_{misfit:g}"] = {"campaigns": len(here), **numbers}


def _always(rows: Sequence[dict[str, Any]]) -> dict[str, tuple[int, int]]:
    """Of how many of the card's intervals with two ends, identified or not, the truth is inside."""
    out: dict[str, tuple[int, int]] = {}
    for row in rows:
        for symbol, place in zip(row["symbols"], row["place"], strict=True):
            if place is not None:
                hits, trials = out.get(symbol, (0, 0))
                out[symbol] = (hits + (abs(place) <= 1.0), trials + 1)
    return out
