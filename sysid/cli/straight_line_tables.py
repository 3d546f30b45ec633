"""The straight-line recipes as tables for people."""

import math
from collections.abc import Sequence

from rich.table import Table

from sysid.cli.console import Talk
from sysid.identification.straight_lines.bias import Bias
from sysid.identification.straight_lines.curvature import Curvature
from sysid.identification.straight_lines.levels import amperes, by_current
from sysid.identification.straight_lines.lines import Line
from sysid.identification.straight_lines.recipes import StraightLines, TemperatureLine
from sysid.identification.straight_lines.stage import Reading, Stage
from sysid.identification.straight_lines.words import sentences


def show_straight_lines(
    talk: Talk,
    found: StraightLines,
    bias: Bias | None = None,
    unbiased: StraightLines | None = None,
) -> None:
    """Lines against temperature, what they rest on, and what the recipes are wrong by.

    Args:
        talk: Where to.
        found: What the recipes gave.
        bias: What they make of the loops of the refined fit, if there is one.
        unbiased: The lines without it, by which it is judged whether they bend.
    """
    talk.show(line_table(found, unbiased))
    for sentence in sentences(found, unbiased):
        talk.say(sentence)
    if bias is not None:
        talk.show(bias_table(found, bias))


def line_table(found: StraightLines, unbiased: StraightLines | None = None) -> Table:
    """One row a quantity and current."""
    judged = "" if unbiased is None else "; curvature: of the lines without the recipes' bias"
    table = Table(
        title="Straight-line identification (Batterbee and Sims 2009)",
        caption=f"intervals: 95 %{judged}",
    )
    table.add_column("quantity")
    for name in ("current / A", "at 0 °C", "per kelvin", "between / °C", "change"):
        table.add_column(name, justify="right", no_wrap=True)
    for name in ("scatter", "tests"):
        table.add_column(name, justify="right")
    table.add_column("curvature")
    bends = {
        (stage.symbol, told.current): told.curvature
        for stage, lines in _laws(unbiased or found)
        for told in lines
    }
    for stage, lines in _laws(found):
        for told in lines:
            cells = (*_numbers(told.line), _curvature(bends.get((stage.symbol, told.current))))
            table.add_row(_named(stage), amperes(told.current), *cells)
    if found.independence is not None:
        one, k = found.independence, found.stiffness
        apart = "currents differ" if one.shown else "currents not told apart"
        cells = (*_numbers(one.line), f"{apart} (p = {one.p:.2g})")
        table.add_row(_named(k), "pooled", *cells)
    if found.offset_line is not None:
        cells = (*_numbers(found.offset_line.line, per_cent=False), "")
        table.add_row("offset / N", "all", *cells)
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
            table.add_row(stage.symbol, amperes(current), *(f"{100 * z:+.1f} %" for z in numbers))
    return table


def _laws(found: StraightLines) -> tuple[tuple[Stage, Sequence[TemperatureLine]], ...]:
    return (
        (found.viscosity, found.viscosity_lines),
        (found.yield_force, found.yield_lines),
        (found.stiffness, found.stiffness_lines),
    )


def _numbers(line: Line, *, per_cent: bool = True) -> tuple[str, ...]:
    (_, high), (_, steep) = line.intervals
    cold, hot = line.ends
    if per_cent:
        z = line.change(cold, hot)
        change = f"{z.percent:+.1f} % ({z.low:+.1f} … {z.high:+.1f})"
    else:
        low, middle, up = ((hot - cold) * b for b in (2 * line.slope - steep, line.slope, steep))
        change = f"{middle:+.3g} ({low:+.3g} … {up:+.3g})"
    return (
        f"{line.intercept:.5g} ± {high - line.intercept:.2g}",
        f"{line.slope:.4g} ± {steep - line.slope:.2g}",
        f"{cold:.3g}, {hot:.3g}",
        change,
        f"{line.scatter:.2g}",
        str(line.value.size),
    )


def _curvature(bends: Curvature | None) -> str:
    if bends is None or not math.isfinite(bends.p):
        return "too few tests"
    if not bends.shown:
        return f"not shown (p = {bends.p:.2g})"
    best = bends.best.name
    better = "no rival is better" if best == "line" else f"{best} is better"
    return f"{bends.bend:.1%} (p = {bends.p:.2g}), {better}"


def _named(stage: Stage) -> str:
    return f"{stage.symbol} / {stage.unit if stage.unit == 'N' else f'({stage.unit})'}"


def _warmth(reading: Reading) -> float:
    return reading.temperature if math.isfinite(reading.temperature) else -math.inf
