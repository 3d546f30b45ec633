"""The paper's straight-line identification of a campaign: three stages, then lines against T."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from sysid.data.loops import Loops
from sysid.errors import FitError
from sysid.identification.straight_lines.bias import Bias, without
from sysid.identification.straight_lines.choice import (
    Chosen,
    fast_excitation,
    high_levels,
    printed_level,
    slow_excitation,
)
from sysid.identification.straight_lines.curvature import Curvature, curvature_of
from sysid.identification.straight_lines.independence import Independence, independence_of
from sysid.identification.straight_lines.levels import (
    Excitation,
    amperes,
    by_current,
    current_levels,
    excitations,
)
from sysid.identification.straight_lines.lines import FEWEST_TESTS, Line, fit_line
from sysid.identification.straight_lines.scatter import ScatterSplit, split_scatter
from sysid.identification.straight_lines.stage import Measure, Reading, Stage, read_tests
from sysid.identification.straight_lines.stiffness import stiffness_measure
from sysid.identification.straight_lines.viscosity import measure_viscosity
from sysid.identification.straight_lines.windows import Window, Windows
from sysid.identification.straight_lines.yield_force import measure_yield_force

_TELLING: Final = 10
"""Degrees of freedom from which the causes of scatter are told apart well enough for weights."""


@dataclass(frozen=True)
class TemperatureLine:
    """A quantity against temperature at one current.

    Attributes:
        current: A.
        line: With its interval.
        curvature: Lack of fit of the line.
    """

    current: float
    line: Line
    curvature: Curvature


@dataclass(frozen=True)
class StraightLines:
    """What the straight-line recipes give for a campaign.

    Attributes:
        viscosity: C_post of every test taken.
        yield_force: F_y.
        stiffness: k.
        viscosity_lines: One a current.
        yield_lines: One a current.
        stiffness_lines: One a current.
        stiffness_line: The one that the paper prints: at 1 A, or at the largest current.
        independence: All high currents pooled, and whether they may be.
        offset_line: Offset of force against temperature, from the tests of F_y: gas, and load
            cell.
        scatter: Of k about its lines, split by cause.
        undetermined: What the campaign lacks for the rest, in words.
    """

    viscosity: Stage
    yield_force: Stage
    stiffness: Stage
    viscosity_lines: tuple[TemperatureLine, ...]
    yield_lines: tuple[TemperatureLine, ...]
    stiffness_lines: tuple[TemperatureLine, ...]
    stiffness_line: TemperatureLine | None
    independence: Independence | None
    offset_line: TemperatureLine | None
    scatter: ScatterSplit | None
    undetermined: tuple[str, ...]


def straight_line_fits(
    loops: Loops,
    *,
    windows: Windows | None = None,
    fast: tuple[float, float] | None = None,
    slow: tuple[float, float] | None = None,
    high_currents: Sequence[float] | None = None,
    temperature_sd: float | None = None,
    bias: Bias | None = None,
) -> StraightLines:
    """Identify C_post, F_y and k by straight lines, and each against temperature.

    The recipes are biased even on perfect data, by a few per cent that depend on the windows:
    `recipe_bias` tells by how much on the loops of a model.

    Args:
        loops: Steady loops of the campaign.
        windows: Points to use; as the paper is read, if not given.
        fast: m, Hz, excitation for C_post and k, in place of 10 mm at 8 Hz.
        slow: m, Hz, excitation for F_y, in place of 5 mm at 4 Hz.
        high_currents: A, for k, in place of 0.8, 1 and 2 A.
        temperature_sd: K, error of the temperatures, where it is known.
        bias: To be divided out of what is read.

    Raises:
        FitError: No test has a known current.

    Source:
        C. K. Batterbee, N. D. Sims, Temperature sensitive controller performance of MR dampers,
        J. Intell. Mater. Syst. Struct. 20 (2009), section 3, Fig. 5.
    """
    known = np.flatnonzero(np.isfinite(loops.current))
    if known.size == 0:
        raise FitError(
            "no test has a known current",
            advice="Tell the currents in tests.csv, in the file names or in campaign.toml",
        )
    windows = windows or Windows()
    groups = [_only(g, known) for g in excitations(loops.select(known))]
    chosen = fast_excitation(groups, fast)
    slower = slow_excitation(groups, chosen.excitation, slow)

    viscosity = _stage(
        loops, chosen, ("C_post", "post-yield viscosity", "N·s/m"), windows.post,
        windows.post_grid, measure_viscosity, None if bias is None else bias.viscosity,
    )  # fmt: skip
    yielding = _stage(
        loops, slower, ("F_y", "yield force", "N"), windows.yielding, windows.yield_grid,
        measure_yield_force, None if bias is None else bias.yield_force,
    )  # fmt: skip
    yield_lines = _lines(yielding.readings)
    stiffness = _stage(
        loops, _high(loops, chosen, high_currents), ("k", "stiffness", "N/m"), windows.stiffness,
        windows.stiffness_grid,
        stiffness_measure(_yield_of(loops, yield_lines), windows.yielding),
        None if bias is None else bias.stiffness,
    )  # fmt: skip
    viscosity_lines = _lines(viscosity.readings)
    levels = _levels(stiffness.readings)
    scatter = split_scatter(levels, temperature_sd)
    stiffness_lines = _lines(stiffness.readings, _telling(scatter))
    printed = printed_level([z for z, _ in levels]) if levels else None
    return StraightLines(
        viscosity=viscosity,
        yield_force=yielding,
        stiffness=stiffness,
        viscosity_lines=viscosity_lines,
        yield_lines=yield_lines,
        stiffness_lines=stiffness_lines,
        stiffness_line=next((z for z in stiffness_lines if z.current == printed), None),
        independence=independence_of(levels, _telling(scatter)),
        offset_line=_offset_line(yielding.readings),
        scatter=scatter,
        undetermined=_undetermined(
            (viscosity, viscosity_lines), (yielding, yield_lines), (stiffness, stiffness_lines)
        ),
    )


def lines_without(found: StraightLines, bias: Bias) -> StraightLines:
    """The same with a bias divided out of the lines, and of nothing else.

    The recipes' bias changes with temperature and bends lines whose truth is straight: whether a
    law bends is asked of these.

    Args:
        found: What the recipes gave.
        bias: Theirs, on loops of a model.
    """
    return replace(
        found,
        viscosity_lines=_lines(without(found.viscosity.readings, bias.viscosity)),
        yield_lines=_lines(without(found.yield_force.readings, bias.yield_force)),
        stiffness_lines=_lines(
            without(found.stiffness.readings, bias.stiffness), _telling(found.scatter)
        ),
    )


def _only(group: Excitation, known: np.ndarray) -> Excitation:
    tests = tuple(int(known[k]) for k in group.tests)
    return Excitation(group.amplitude, group.frequency, tests)


def _stage(
    loops: Loops,
    chosen: Chosen,
    named: tuple[str, str, str],
    window: Window,
    grid: tuple[Window, ...],
    measure: Measure,
    bias: dict[str, float] | None,
) -> Stage:
    tests = () if chosen.excitation is None else chosen.excitation.tests
    readings, left_out = read_tests(loops, tests, window, grid, measure)
    if bias is not None:
        unknown = {r.id: "the recipe's bias is not known for it" for r in readings}
        left_out |= {id: why for id, why in unknown.items() if id not in bias}
        readings = without(readings, bias)
    return Stage(*named, chosen.rule, window, grid, readings, left_out)


def _high(loops: Loops, chosen: Chosen, wanted: Sequence[float] | None) -> Chosen:
    """The tests of the fast excitation with high currents."""
    group = chosen.excitation
    if group is None:
        return chosen
    tests = np.array(group.tests)
    levels = current_levels(loops.current[tests])
    if wanted is None:
        high = high_levels([z for z, _ in levels])
    else:
        high = tuple(z for z, _ in levels if min(abs(z - w) for w in wanted) < 0.05)
    if not high:
        return Chosen(None, f"{group} was not measured at a high current")
    kept = np.sort(np.concatenate([tests[at] for z, at in levels if z in high]))
    amps = ", ".join(amperes(z) for z in high)
    narrowed = Excitation(group.amplitude, group.frequency, tuple(kept.tolist()))
    return Chosen(narrowed, f"{chosen.rule}; high currents: {amps} A")


def _levels(readings: Sequence[Reading]) -> list[tuple[float, list[Reading]]]:
    """Readings with known temperature by current."""
    return by_current([r for r in readings if np.isfinite(r.temperature)])


def _lines(
    readings: Sequence[Reading], scatter: ScatterSplit | None = None
) -> tuple[TemperatureLine, ...]:
    """One line a current, weighted by what is known of the scatter."""
    told = []
    for z, same in _levels(readings):
        values, se = [r.value for r in same], [r.se for r in same]
        line = _line(same, values, se)
        if line is not None and scatter is not None:
            line = _line(same, values, se, scatter.beyond(line))
        if line is not None:
            told.append(TemperatureLine(z, line, curvature_of(line)))
    return tuple(told)


def _telling(scatter: ScatterSplit | None) -> ScatterSplit | None:
    return None if scatter is None or scatter.freedom < _TELLING else scatter


def _offset_line(readings: Sequence[Reading]) -> TemperatureLine | None:
    """Offsets of all currents against temperature; their errors show in the scatter."""
    warm = [r for r in readings if np.isfinite(r.temperature)]
    line = _line(warm, [r.offset for r in warm], [np.nan] * len(warm))
    return None if line is None else TemperatureLine(float("nan"), line, curvature_of(line))


def _line(
    readings: Sequence[Reading],
    values: list[float],
    se: list[float],
    beyond: np.ndarray | None = None,
) -> Line | None:
    t = np.array([r.temperature for r in readings])
    if t.size < FEWEST_TESTS or np.ptp(t) <= 0.0:
        return None
    replicates = np.array([float(r.replicates) for r in readings])
    return fit_line(t, np.array(values), np.array(se), replicates, beyond)


def _yield_of(loops: Loops, lines: Sequence[TemperatureLine]) -> np.ndarray:
    """F_y at each test's current and temperature; NaN at currents without a line."""
    told = np.full(len(loops.ids), np.nan)
    known = np.flatnonzero(np.isfinite(loops.current) & np.isfinite(loops.temperature))
    for line in lines:
        gap = np.abs(np.abs(loops.current[known]) - line.current)
        near = known[gap < 0.03 * (1.0 + line.current)]
        told[near] = line.line.at(loops.temperature[near])[0]
    return np.where(told > 0.0, told, np.nan)


def _undetermined(*stages: tuple[Stage, Sequence[TemperatureLine]]) -> tuple[str, ...]:
    told = []
    for stage, lines in stages:
        if not stage.readings:
            why = next(iter(stage.left_out.values()), stage.rule)
            told.append(f"{stage.symbol} is not determined: {why}")
        elif not lines:
            told.append(
                f"{stage.symbol} against temperature is not determined: no current has "
                f"{FEWEST_TESTS} tests at known and different temperatures"
            )
    return tuple(told)
