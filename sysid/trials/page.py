"""The study as a page and as numbers."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sysid.trials.curves import calibration, power
from sysid.trials.markdown import table_lines
from sysid.trials.one import id_of, row_of
from sysid.trials.outcome import Row
from sysid.trials.proportions import Share, bootstrap
from sysid.trials.score import RIGHT
from sysid.trials.summary import Count, Rate, baseline, confusions, gain_ratio, ours, rates, sizes
from sysid.trials.trial_id import PHYSICAL, TrialId, parse_id


@dataclass(frozen=True)
class Result:
    """A finished trial.

    Attributes:
        trial: Which.
        row: What came out.
        program: Fingerprint of the program, where it is known.
    """

    trial: TrialId
    row: Row
    program: str


def result_of(values: dict[str, Any]) -> Result:
    """A line of results.

    Raises:
        DataError: It is none.
    """
    program = str(values.get("program") or values.get("commit") or "unknown")
    return Result(parse_id(id_of(values) or ""), row_of(values), program)


@dataclass(frozen=True)
class Page:
    """A page.

    Attributes:
        text: Markdown.
        numbers: The same for JSON.
    """

    text: str
    numbers: dict[str, Any]


def page_of(results: Sequence[Result], missing: int | None, failures: dict[str, str]) -> Page:
    """Everything that the finished trials say, with 95 % intervals.

    Args:
        results: Finished trials.
        missing: Trials of the plan that are not finished; None where there is no plan.
        failures: Trial → why it could not be run.
    """
    rows = [r.row for r in results if r.trial.regime != PHYSICAL]
    programs = Counter(r.program for r in results)
    rest = "" if missing is None else f", {missing} of the plan are missing"
    lines = [
        "# Blind trials", "",
        f"{len(results)} trials{rest}; program "
        f"{', '.join(f'{name} ({n})' for name, n in programs.most_common()) or 'none'}. Rates are "
        "hits/trials = share, with Wilson's 95 % interval. The baseline is sparse regression of "
        "what the fitted base leaves, scored by the same rules. Visible: the bound on naming is at "
        "least 95 % in that campaign; the others apart.",
    ]  # fmt: skip
    numbers: dict[str, Any] = {
        "schema": "sysid-trials-1", "trials": len(results), "missing": missing,
        "programs": dict(programs),
    }  # fmt: skip
    for part in (_rates(results), _figures(rows), _sizes(rows), _calibration(rows), _power(rows),
                 _confusion(rows), _physical(results), _failures(results, failures)):  # fmt: skip
        lines += part.text.splitlines()
        numbers |= part.numbers
    return Page("\n".join(lines) + "\n", numbers)


def _rates(results: Sequence[Result]) -> Page:
    """Rates kind by kind; targets are those of the regimes as they stand."""
    kinds: dict[str, list[Row]] = {}
    for r in results:
        if r.trial.regime != PHYSICAL:
            plain = r.trial.kind == r.trial.regime
            kinds.setdefault("" if plain else r.trial.kind, []).append(r.row)
    table, numbers = [], []
    for kind, rows in sorted(kinds.items()):
        theirs = {(r.regime, r.what): r.count for r in rates(rows, baseline)}
        for rate in rates(rows, ours):
            if kind and rate.regime.startswith("all"):
                continue
            share, other = _share(rate.count), theirs.get((rate.regime, rate.what))
            beside = None if other is None else _share(other)
            name, target = kind or rate.regime, "" if kind else rate.target
            table.append([name, rate.what, target, share, beside or ""])
            numbers.append(
                {"regime": name, "what": rate.what, "target": target}
                | {"diagnosis": share.as_dict(), "baseline": beside and beside.as_dict()}
            )
    if not table:
        return Page("", {"rates": []})
    head = ["regime", "counted", "target", "diagnosis", "baseline"]
    return Page("\n".join(table_lines(head, table)), {"rates": numbers})


def _figures(rows: Sequence[Row]) -> Page:
    """Sizes, gains and times."""
    table: list[list[object]] = []
    numbers: dict[str, Any] = {}
    recovered = sizes(rows)
    if recovered is not None:
        covered = _share(recovered.covered)
        off = [q.value / q.true - 1.0 for r in rows for q in r.recovered
               if q.identified and q.exact and q.true != 0.0]  # fmt: skip
        table += [
            ["bias of sizes (median)", "≤ 10 %", _percent(_median(np.array(off)))],
            ["largest bias of one parameter", "", f"{100 * recovered.worst:.1f} %"],
            ["95 % intervals cover", "90 to 98 %", covered],
            ["RMS force added / planted (median)", "", f"{recovered.force:.2f}"],
        ]
        numbers["sizes"] = asdict(recovered) | {"covered": covered.as_dict()}
    some = [r for r in rows if r.causes and r.visible and (r.oracle_gain or 0.0) > 0.0 and r.score]
    gain = gain_ratio(some)
    if gain is not None:
        found = bootstrap(lambda chosen: _of_sums([some[k] for k in chosen]), len(some))
        value, low, high = found
        shown = f"{value:.2f} ({low:.2f} to {high:.2f}); {gain[1]:.2f}; {gain[2]}"
        table.append(["achieved / oracle gain (of sums; median; trials)", "≥ .9", shown])
        numbers["gain"] = {
            "of_sums": value, "low": low, "high": high, "median": gain[1], "trials": gain[2],
        }  # fmt: skip
    took = sorted(row.seconds for row in rows if row.score is not None)
    if took:
        shown = f"{took[len(took) // 2]:.0f}; {took[-1]:.0f}"
        table.append(["seconds a diagnosis, others running (median; longest)", "", shown])
        numbers["seconds"] = {"median": took[len(took) // 2], "longest": took[-1]}
    if not table:
        return Page("", numbers)
    return Page("\n".join(table_lines(["figure", "target", "reached"], table)), numbers)


def _sizes(rows: Sequence[Row]) -> Page:
    """How often the interval of each parameter of an effect holds its true value."""
    holds: dict[tuple[str, str], list[bool]] = {}
    for q in (q for r in rows for q in r.recovered if q.identified and q.exact):
        holds.setdefault((q.id, q.symbol), []).append(q.low <= q.true <= q.high)
    shares = [(*name, Share(sum(z), len(z))) for name, z in sorted(holds.items())]
    numbers = {"sizes_by_parameter": {f"{i}.{s}": z.as_dict() for i, s, z in shares}}
    if not shares:
        return Page("", numbers)
    lines = ["", "Sizes of rightly named effects, by parameter:"]
    lines += table_lines(["effect", "parameter", "95 % interval holds the truth"], shares)
    return Page("\n".join(lines), numbers)


def _calibration(rows: Sequence[Row]) -> Page:
    bins = calibration(rows)
    if not bins:
        return Page("", {"calibration": []})
    table = [[f"{b.low:g} to {b.high:g}", f"{b.stated:.3f}", b.right] for b in bins]
    lines = ["", "Is stated confidence kept? Names and classes by the confidence they came with:"]
    lines += table_lines(["confidence", "mean", "right"], table)
    numbers = [
        {"low": b.low, "high": b.high, "stated": b.stated} | {"right": b.right.as_dict()}
        for b in bins
    ]
    return Page("\n".join(lines), {"calibration": numbers})


def _power(rows: Sequence[Row]) -> Page:
    bins = power(rows)
    if not bins:
        return Page("", {"power": []})
    table = [
        [f"{b.low:g} to {b.high:g}" if np.isfinite(b.high) else f"above {b.low:g}", b.found,
         f"{100 * b.ideal:.0f} %"]
        for b in bins
    ]  # fmt: skip
    lines = [
        "",
        "Power: hidden effects by d′, how far each stands out of noise and rig behind what the "
        "base absorbs. At best: the probability that a test with known covariance detects it and "
        "tells it from its nearest rival.",
        *table_lines(["d′", "right name or class", "at best"], table),
    ]
    numbers = [
        {"low": b.low, "high": b.high if np.isfinite(b.high) else None, "ideal": b.ideal}
        | {"found": b.found.as_dict()}
        for b in bins
    ]
    return Page("\n".join(lines), {"power": numbers})


def _confusion(rows: Sequence[Row]) -> Page:
    confused = confusions(rows)
    if not confused:
        return Page("", {"confusions": []})
    lines = ["", "What was hidden, and what was answered:"]
    lines += table_lines(["hidden", "answer", "trials"], confused)
    return Page("\n".join(lines), {"confusions": [list(z) for z in confused]})


def physical_rates(rows: Sequence[Row]) -> tuple[Rate, ...]:
    """What is counted of trials on the physical damper."""
    judged = [j for r in rows if r.score for j in r.score.judged]
    # at a level of 0 a mechanism is taken out, and there is nothing to find
    found = [r.score.found[0] for r in rows if r.score and r.score.found]
    made = (
        Rate(PHYSICAL, "names that are false or out of family, of all given",
             Count(sum(j.verdict == "wrong" for j in judged), len(judged)), "≤ 5 %"),
        Rate(PHYSICAL, "raised mechanism named, or its class",
             Count(sum(z in RIGHT for z in found), len(found)), "≥ 80 %"),
        Rate(PHYSICAL, "its family at least",
             Count(sum(z in (*RIGHT, "right_family") for z in found), len(found))),
        Rate(PHYSICAL, "trials with a false name",
             Count(sum(r.score.spurious > 0 for r in rows if r.score),
                   sum(r.score is not None for r in rows))),
    )  # fmt: skip
    return tuple(rate for rate in made if rate.count.trials)


def _physical(results: Sequence[Result]) -> Page:
    kinds: dict[str, list[Row]] = {}
    for r in results:
        if r.trial.regime == PHYSICAL:
            kinds.setdefault(r.trial.kind, []).append(r.row)
    if not kinds:
        return Page("", {"physical": []})
    table, numbers = [], []
    for kind, rows in kinds.items():
        for rate in physical_rates(rows):
            share = _share(rate.count)
            table.append([kind, rate.what, rate.target, share])
            numbers.append(
                {"kind": kind, "what": rate.what, "target": rate.target} | share.as_dict()
            )
    each = [
        [str(r.trial), ", ".join(r.row.planters) or "nothing",
         ", ".join(f"{z:.2g}" for z in r.row.percents), answer_words(r.row),
         f"{r.row.before:.2f}", f"{r.row.before - r.row.gain:.2f}"]
        for r in results if r.trial.regime == PHYSICAL
    ]  # fmt: skip
    lines = [
        "",
        "The physical damper, which no base matches: all its mechanisms are at work, one is "
        "raised. A name is false if it is the cause of no mechanism.",
        *table_lines(["kind", "counted", "target", "diagnosis"], table),
        *table_lines(
            ["trial", "raised", "changes the force by, %", "answer", "error before, %", "after, %"],
            each,
        ),
    ]
    return Page("\n".join(lines), {"physical": numbers})


def answer_words(row: Row) -> str:
    """What was answered, each name with its verdict."""
    if row.failure:
        return row.failure
    given = [] if row.score is None else row.score.judged
    names = (
        f"{'/'.join(j.given.members) or f'family {j.given.family}'} ({j.verdict})" for j in given
    )
    return ", ".join(names) or row.answer


def _failures(results: Sequence[Result], failures: dict[str, str]) -> Page:
    told = [
        [str(r.trial), ", ".join(r.row.planters), r.row.failure] for r in results if r.row.failure
    ]
    told += [[name, "", why] for name, why in failures.items()]
    if not told:
        return Page("", {"failures": []})
    lines = ["", f"{len(told)} trials gave no result:"]
    return Page(
        "\n".join([*lines, *table_lines(["trial", "hidden", "why"], told)]), {"failures": told}
    )


def _share(count: Count) -> Share:
    return Share(count.hits, count.trials)


def _of_sums(rows: Sequence[Row]) -> float:
    found = gain_ratio(rows)
    return float("nan") if found is None else found[0]


def _median(values: np.ndarray) -> tuple[float, float, float]:
    return bootstrap(lambda chosen: float(np.median(values[chosen])), len(values))


def _percent(found: tuple[float, float, float]) -> str:
    value, low, high = (100 * z for z in found)
    return f"{value:.1f} % ({low:.1f} to {high:.1f})"
