"""Results as tables for people."""

import math
from collections.abc import Mapping, Sequence

from rich.markup import escape
from rich.table import Table

from sysid.cli.console import Talk
from sysid.identification.result import Fit, TestError
from sysid.uncertainty.estimate import Estimate, Estimates
from sysid.uncertainty.side_by_side import SideBySide


def show_fit(
    talk: Talk, title: str, fit: Fit, intervals: SideBySide, noise: Mapping[str, float]
) -> None:
    """Parameters, errors, and how the fit ended.

    Args:
        talk: Of the command.
        title: Of the fit.
        fit: The fit.
        intervals: Of its parameters.
        noise: Test → noise of its mean cycle, N.
    """
    estimates = intervals.card
    talk.show(parameter_table(title, estimates))
    talk.show(interval_table(intervals))
    talk.show(error_table([t for t in fit.tests if t.used or t.held_out], noise))
    held = fit.held_out_mean_nrmse
    told = "" if held is None else f", held-out tests {held:.2%}"
    talk.say(f"Mean RMSE/max|F|: fitted tests {fit.mean_nrmse:.2%}{told}. {fit.result.value}")
    for sentence in estimates.undetermined:
        talk.say(f"Open: {sentence}.")
    talk.notes(fit.notes)


def parameter_table(title: str, estimates: Estimates) -> Table:
    """Parameters with their intervals; no number where the data give none."""
    table = Table(
        title=escape(title), caption=f"{estimates.interval}: values and intervals of the card"
    )
    for name, side in (("", "left"), ("value", "right"), ("interval", "right"), ("unit", "left")):
        table.add_column(name, justify=side)  # type: ignore[arg-type]  # literals, but typed str
    table.add_column("meaning")
    for p in estimates.parameters:
        if not p.identified:
            shown, interval = "–", "not determined by these data"
        elif p.sd > 0.0:
            shown, interval = f"{p.value:.5g}", f"{p.low:.5g} … {p.high:.5g}"
        else:
            shown, interval = f"{p.value:.5g}", "fixed"
        table.add_row(p.symbol, shown, interval, p.unit, p.name)
    return table


def interval_table(intervals: SideBySide) -> Table:
    """Intervals by several rules: the middle of each, and half of its width."""
    rules = intervals.all
    table = Table(
        title="Intervals side by side",
        caption="; ".join(f"{'abcdefgh'[k]}: {e.interval}" for k, e in enumerate(rules))
        + ". a stands in the card.",
    )
    table.add_column("")
    for k in range(len(rules)):
        table.add_column("abcdefgh"[k], justify="right")
    table.add_column("unit")
    for places in zip(*(e.parameters for e in rules), strict=True):
        first = places[0]
        if first.symbol in intervals.card.symbols:
            table.add_row(first.symbol, *(_half(p) for p in places), first.unit)
    return table


def _half(p: Estimate) -> str:
    if not (p.identified and math.isfinite(p.high - p.low)):
        return "–"
    return f"{0.5 * (p.low + p.high):.5g} ± {0.5 * (p.high - p.low):.2g}"


def error_table(tests: Sequence[TestError], noise: Mapping[str, float]) -> Table:
    """Free-run errors, worst first, beside what a perfect model would leave.

    Args:
        tests: Their errors.
        noise: Test → noise of its mean cycle, N; those that are no loops are not in it.
    """
    table = Table(
        title="Free-run error over the steady loop",
        caption="worst first; a perfect model would leave the noise of the mean cycle",
    )
    table.add_column("test", overflow="fold")
    for name in ("RMSE / N", "of max|F|", "fit %", "noise of the mean cycle / N"):
        table.add_column(name, justify="right")
    table.add_column("")
    for t in sorted(tests, key=lambda t: (-t.nrmse, t.id)):
        own = noise.get(t.id, math.nan)
        floor = f"{own:.3g}" if math.isfinite(own) else "unknown"
        table.add_row(
            escape(t.id), f"{t.rmse:.4g}", f"{t.nrmse:.2%}", f"{t.fit_percent:.1f}", floor,
            "held out" if t.held_out else "",
        )  # fmt: skip
    return table
