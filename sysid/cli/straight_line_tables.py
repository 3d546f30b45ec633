"""The straight-line recipes as tables for people."""

import math
from collections.abc import Sequence

from rich.table import Table

from sysid.cli.console import Talk
from sysid.identification.straight_lines.bias import Bias
from sysid.identification.straight_lines.levels import by_current
from sysid.identification.straight_lines.recipes import StraightLines, TemperatureLine
from sysid.identification.straight_lines.stage import Reading, Stage
from sysid.identification.straight_lines.words import sentences


def show_straight_lines(talk: Talk, found: StraightLines, bias: Bias | None = None) -> None:
    """Lines against temperature, what they rest on, and what the recipes are wrong by.

    Args:
        talk: Where to.
        found: What the recipes gave.
        bias: What they make of the loops of the refined fit, if there is one.
    """
    talk.show(line_table(found))
    for sentence in sentences(found):
        talk.say(sentence)
    if bias is not None:
        talk.show(bias_table(found, bias))


def line_table(found: StraightLines) -> Table:
    """One row a quantity and current."""
    table = Table(
        title="Straight-line identification (Batterbee and Sims 2009)", caption="intervals: 95 %"
    )
    table.add_column("quantity")
    for name in ("current / A", "at 0 °C", "per kelvin", "change", "scatter", "tests"):
        table.add_column(name, justify="right")
    table.add_column("bends?")
    for stage, lines in _laws(found):
        for told in lines:
            table.add_row(f"{stage.symbol} / ({stage.unit})", f"{told.current:.3g}", *_cells(told))
    if found.independence is not None:
        line, p = found.independence.line, found.independence.p
        k = found.stiffness
        apart = f"currents differ (p = {p:.2g})" if found.independence.shown else "as one"
        cells = _numbers(TemperatureLine(math.nan, line, found.stiffness_lines[0].curvature))
        table.add_row(f"{k.symbol} / ({k.unit})", "pooled", *cells, apart)
    if found.offset_line is not None:
        table.add_row("offset / N", "all", *_cells(found.offset_line))
    return table


def bias_table(found: StraightLines, bias: Bias) -> Table:
    """What the recipes make of the refined fit's own loops, by quantity and current."""
    table = Table(
        title="Bias of the recipes on the loops of the refined fit",
        caption="recipe over the fit's parameter, minus one; from coldest to warmest test",
    )
    table.add_column("quantity")
    for name in ("current / A", "coldest", "warmest", "smallest", "largest"):
        table.add_column(name, justify="right")
    known = (bias.viscosity, bias.yield_force, bias.stiffness)
    for (stage, _), by_test in zip(_laws(found), known, strict=True):
        readings = [r for r in stage.readings if r.id in by_test]
        for current, same in by_current(readings):
            shown = [by_test[r.id] for r in sorted(same, key=_warmth)]
            numbers = (shown[0], shown[-1], min(shown), max(shown))
            table.add_row(stage.symbol, f"{current:.3g}", *(f"{100 * z:+.1f} %" for z in numbers))
    return table


def _laws(found: StraightLines) -> tuple[tuple[Stage, Sequence[TemperatureLine]], ...]:
    return (
        (found.viscosity, found.viscosity_lines),
        (found.yield_force, found.yield_lines),
        (found.stiffness, found.stiffness_lines),
    )


def _numbers(told: TemperatureLine) -> tuple[str, ...]:
    line = told.line
    (_, high), (_, steep) = line.intervals
    change = line.change(*line.ends)
    return (
        f"{line.intercept:.5g} ± {high - line.intercept:.2g}",
        f"{line.slope:.4g} ± {steep - line.slope:.2g}",
        f"{change.percent:+.1f} % ({change.low:+.1f} … {change.high:+.1f}) "
        f"{change.cold:.3g} → {change.hot:.3g} °C",
        f"{line.scatter:.2g}",
        str(line.value.size),
    )


def _cells(told: TemperatureLine) -> tuple[str, ...]:
    bends = told.curvature
    if not math.isfinite(bends.p):
        return (*_numbers(told), "too few tests to tell")
    if not bends.shown:
        return (*_numbers(told), f"no curvature shown (p = {bends.p:.2g})")
    return (
        *_numbers(told),
        f"bends by {bends.bend:.1%} (p = {bends.p:.2g}), best: {bends.best.name}",
    )


def _warmth(reading: Reading) -> float:
    return reading.temperature if math.isfinite(reading.temperature) else -math.inf
