"""The test matrix: every test a cell with its error, conditions down, currents across."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from sysid.identification.straight_lines.levels import amperes, current_levels
from sysid.report.page.one_test import OneTest
from sysid.report.page.wording import UNKNOWN, condition, share

BANDS: Final = (0.01, 0.02, 0.05, 0.10, 0.20)
"""RMSE/max|F| at which a cell takes the next darker colour."""


GAP: Final = 0.05
"""In parts, between two amplitudes or frequencies that were meant to differ."""


@dataclass(frozen=True)
class Cell:
    """One test.

    Attributes:
        place: Of the test among all.
        id: Of the test.
        text: Error of the last model in per cent, without the sign of it.
        band: 0 … len(BANDS), −1 where no error is known.
        note: Temperature, where several tests share a condition.
        role: Of the test.
        errors: RMSE/max|F| of all models; None where not known.
        label: All of it in words.
    """

    place: int
    id: str
    text: str
    band: int
    note: str
    role: str
    errors: tuple[float | None, ...]
    label: str


@dataclass(frozen=True)
class Row:
    """Tests of one amplitude and frequency.

    Attributes:
        name: Of the condition.
        speed: Peak velocity; empty where there is none.
        cells: One group a column.
    """

    name: str
    speed: str
    cells: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True)
class Matrix:
    """All tests.

    Attributes:
        models: Names, the last one shown first.
        columns: Currents.
        rows: Conditions.
        bands: Limits of the colours, RMSE/max|F|.
    """

    models: tuple[str, ...]
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    bands: tuple[float, ...] = BANDS

    @property
    def cells(self) -> tuple[Cell, ...]:
        """All cells."""
        return tuple(c for row in self.rows for group in row.cells for c in group)

    @property
    def legend(self) -> tuple[str, ...]:
        """What each colour means."""
        ends = [f"{100.0 * b:g} %" for b in self.bands]
        middle = [f"{a} to {b}" for a, b in pairwise(ends)]
        return (f"below {ends[0]}", *middle, f"above {ends[-1]}")


def matrix(tests: Sequence[OneTest], models: Sequence[str]) -> Matrix:
    """Arrange tests by what was meant to be the same condition.

    Args:
        tests: All tests.
        models: Names of the models, in the order of each test's errors.
    """
    column, columns = _columns([abs(t.current) for t in tests])
    groups = _conditions(tests)
    rows = []
    for name, speed, places in groups:
        cells = [
            tuple(
                _cell(k, tests[k], models, several=len(here) > 1)
                for k in sorted(here, key=lambda k: (tests[k].temperature, tests[k].id))
            )
            for c in range(len(columns))
            for here in [[k for k in places if column[k] == c]]
        ]
        rows.append(Row(name, speed, tuple(cells)))
    return Matrix(tuple(models), columns, tuple(rows))


def band_of(error: float | None) -> int:
    """Which colour an error has."""
    if error is None or not math.isfinite(error):
        return -1
    return sum(error >= limit for limit in BANDS)


def _columns(current: Sequence[float]) -> tuple[list[int], tuple[str, ...]]:
    i = np.array(current, dtype=np.float64)
    known = np.flatnonzero(np.isfinite(i))
    column, names = [-1] * i.size, []
    for level, places in current_levels(i[known]) if known.size else []:
        for n in places:
            column[known[n]] = len(names)
        names.append(f"{amperes(level)} A")
    if -1 in column:
        column = [len(names) if c < 0 else c for c in column]
        names.append("current unknown")
    return column, tuple(names)


def _conditions(tests: Sequence[OneTest]) -> list[tuple[str, str, list[int]]]:
    """(name, peak velocity, places): sines by amplitude and frequency, other motions by kind."""
    sines = [
        k for k, t in enumerate(tests)
        if t.kind == "sine" and 0.0 < t.amplitude < math.inf and 0.0 < t.frequency < math.inf
    ]  # fmt: skip
    found = []
    for amplitudes in _groups([math.log(tests[k].amplitude) for k in sines], GAP):
        same = [sines[n] for n in amplitudes]
        for inner in _groups([math.log(tests[k].frequency) for k in same], GAP):
            places = [same[n] for n in inner]
            a, f, v = (
                float(np.median([getattr(tests[k], name) for k in places]))
                for name in ("amplitude", "frequency", "peak_velocity")
            )
            found.append((condition(a, f, math.nan), f"{v:.2g} m/s", places))
    rest = [k for k in range(len(tests)) if k not in set(sines)]
    for kind in dict.fromkeys(tests[k].kind for k in rest):
        name = "other tests" if kind == "sine" else kind.replace("_", " ")
        found.append((name, "", [k for k in rest if tests[k].kind == kind]))
    return found


def _groups(values: Sequence[float], gap: float) -> list[list[int]]:
    """Places of values without a gap between neighbours, lowest first."""
    if not values:
        return []
    order = np.argsort(values, kind="stable")
    wide = np.diff(np.array(values)[order]) > gap
    return [z.tolist() for z in np.split(order, np.flatnonzero(wide) + 1)]


def _cell(place: int, t: OneTest, models: Sequence[str], *, several: bool) -> Cell:
    where = condition(t.amplitude, t.frequency, t.current, t.temperature)
    known = [e if math.isfinite(e) else None for e in t.errors]
    last = known[-1] if known else None
    text = UNKNOWN if last is None else share(last).removesuffix(" %")
    told = ", ".join(f"{m} {share(e)}" for m, e in zip(models, known, strict=False))
    words = [f"Test {t.id}", where, t.role]
    words.append(f"error of the peak force: {told}" if told else f"no error: {t.why or 'unknown'}")
    if math.isfinite(t.noise) and t.peak:
        words.append(f"repeatability (scatter of one cycle) {share(t.noise / t.peak)}")
    note = f"{t.temperature:.3g} °C" if several and math.isfinite(t.temperature) else ""
    label = "; ".join(w for w in words if w)
    if t.role == "left out":
        text = "out"
    return Cell(place, t.id, text, band_of(last), note, t.role, tuple(known), label)
