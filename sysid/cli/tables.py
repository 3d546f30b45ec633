"""Results as tables for people."""

import math
from collections.abc import Sequence

from rich.table import Table

from sysid.cli.console import Talk
from sysid.identification.result import Fit, TestError
from sysid.uncertainty.estimate import Estimates


def show_fit(talk: Talk, title: str, fit: Fit, estimates: Estimates) -> None:
    """Parameters, errors, and how the fit ended."""
    talk.show(parameter_table(title, estimates))
    talk.show(error_table([t for t in fit.tests if t.used or t.held_out]))
    held = fit.held_out_mean_nrmse
    told = "" if held is None else f", held-out tests {held:.2%}"
    talk.say(f"Mean RMSE/max|F|: fitted tests {fit.mean_nrmse:.2%}{told}. {fit.result.value}")
    for sentence in estimates.undetermined:
        talk.say(f"Open: {sentence}.")
    talk.notes(fit.notes)


def parameter_table(title: str, estimates: Estimates) -> Table:
    """Parameters with their intervals; no number where the data give none."""
    table = Table(title=title, caption=estimates.interval)
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


def error_table(tests: Sequence[TestError]) -> Table:
    """Free-run errors, worst first."""
    table = Table(title="Free-run error over the steady loop", caption="worst first")
    table.add_column("test")
    for name in ("RMSE / N", "of max|F|", "fit %", "noise floor / N"):
        table.add_column(name, justify="right")
    table.add_column("")
    for t in sorted(tests, key=lambda t: (-t.nrmse, t.id)):
        floor = f"{t.noise_floor:.3g}" if math.isfinite(t.noise_floor) else "unknown"
        table.add_row(
            t.id, f"{t.rmse:.4g}", f"{t.nrmse:.2%}", f"{t.fit_percent:.1f}", floor,
            "held out" if t.held_out else "",
        )  # fmt: skip
    return table
