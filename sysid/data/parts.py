"""Tables → tests: blocks of one recording joined, tables that hold many tests cut apart.

A table is cut by its ``test`` column if it has one; else wherever an amplitude, frequency, kind or
run order that it repeats on every row changes, together with the steps of a commanded current.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from sysid.data.columns import LABELS, unit_quantity
from sysid.data.readers.base import RawTable
from sysid.errors import DataError
from sysid.units import to_si

_FEWEST_ROWS: Final = 20
"""Rows that a test in a long table has at least, on average."""


@dataclass(frozen=True)
class TestTable:
    """The rows of one test.

    Attributes:
        part: Which part of the file; None where the file is one test.
        table: These rows alone.
        told: Conditions that columns repeat on every row: amplitude (m), frequency (Hz), kind,
            run_order.
    """

    __test__ = False  # not a test of this program

    part: str | None
    table: RawTable
    told: dict[str, object]


def cut_tests(
    tables: Sequence[RawTable], blocks: Literal["auto", "join", "separate"], where: str
) -> tuple[TestTable, ...]:
    """Make tests of a file's tables.

    Args:
        tables: As the reader gives them.
        blocks: What start/resume blocks are: one test (``join``), one each (``separate``), or one
            where time runs on and one each where it starts again (``auto``).
        where: The file, for messages.

    Raises:
        DataError: The rows cannot be told apart into tests.
    """
    joined = _join_blocks(tables, blocks, where)
    tests = [test for table in joined for test in _cut_table(table, where)]
    labels = [test.part for test in tests]
    if len(tests) > 1:
        labels = [label or str(place) for place, label in enumerate(labels, start=1)]
        labels = _unique(labels)
    return tuple(replace(t, part=label) for t, label in zip(tests, labels, strict=True))


def _unique(labels: Sequence[str | None]) -> list[str | None]:
    seen: dict[str | None, int] = {}
    out: list[str | None] = []
    for label in labels:
        seen[label] = seen.get(label, 0) + 1
        out.append(label if seen[label] == 1 else f"{label}_{seen[label]}")
    return out


def _join_blocks(tables: Sequence[RawTable], blocks: str, where: str) -> list[RawTable]:
    out: list[RawTable] = []
    for table in tables:
        if table.block is None or not out or out[-1].part != table.part or blocks == "separate":
            out.append(table)
            continue
        before, after = _ends(out[-1]), _ends(table)
        if before is None or after is None or after[0] <= before[1]:
            if blocks == "join":
                raise DataError(
                    "a block starts at an earlier time than the block before it ends",
                    where=f"{where}, {table.place(0)}",
                    advice="Blocks with a time of their own are tests of their own: write "
                    'blocks = "separate" in campaign.toml',
                )
            out.append(table)
            continue
        out[-1] = _joined(out[-1], table, after[0] - before[1])
    return [_numbered(table, len(out)) for table in out]


def _numbered(table: RawTable, count: int) -> RawTable:
    if table.block is None or count == 1:
        return table
    part = str(table.block) if table.part is None else f"{table.part}.{table.block}"
    return replace(table, part=part)


def _ends(table: RawTable) -> tuple[float, float] | None:
    """First and last time, in the file's unit."""
    time = table.columns.get("time")
    if time is None or time.cells.dtype.kind != "f" or not len(time.cells):
        return None
    return float(time.cells[0]), float(time.cells[-1])


def _joined(first: RawTable, second: RawTable, pause: float) -> RawTable:
    columns = {
        role: replace(column, cells=np.concatenate([column.cells, second.columns[role].cells]))
        for role, column in first.columns.items()
    }
    unit = first.columns["time"].unit
    gap = f"{pause:g} {unit.symbol if unit else ''}".strip()
    said = f"recording resumes in {second.place(0)}, {gap} after the row before; kept as one test"
    return replace(
        first,
        columns=columns,
        rows=np.concatenate([first.rows, second.rows]),
        changes=(*first.changes, said, *second.changes),
    )


def _cut_table(table: RawTable, where: str) -> list[TestTable]:
    groups = _by_key(table, where) if "test" in table.columns else _by_condition(table, where)
    tests = []
    for label, rows in groups:
        piece = table if rows is None else _take(table, rows)
        part = label if table.part is None or label is None else f"{table.part}.{label}"
        tests.append(TestTable(part or table.part, piece, _told(piece, where)))
    return tests


Groups = list[tuple[str | None, NDArray[np.int_] | None]]
"""Label and row indices of each test; None for all rows."""


def _take(table: RawTable, rows: NDArray[np.int_]) -> RawTable:
    columns = {role: replace(c, cells=c.cells[rows]) for role, c in table.columns.items()}
    return replace(table, columns=columns, rows=np.asarray(table.rows)[rows])


def _by_key(table: RawTable, where: str) -> Groups:
    import pandas as pd

    cells = table.columns["test"].cells
    codes, keys = pd.factorize(np.asarray(cells, dtype=object))
    names = [_key_name(key) for key in keys]
    empty = (codes < 0) | np.isin(codes, [i for i, name in enumerate(names) if not name])
    if empty.any():
        raise DataError(
            "the test column is empty", where=f"{where}, {table.place(int(np.argmax(empty)))}"
        )
    if len(names) <= 1:
        return [(None, None)]
    order = np.argsort(codes, kind="stable")
    pieces = np.split(order, np.cumsum(np.bincount(codes))[:-1])
    return list(zip(names, pieces, strict=True))


def _key_name(key: object) -> str:
    return f"{key:g}" if isinstance(key, float) else str(key).strip()


def _by_condition(table: RawTable, where: str) -> Groups:
    count = len(table.rows)
    cut = np.zeros(max(count - 1, 0), dtype=bool)
    labelled = [role for role in (*LABELS, "kind", "run_order") if role in table.columns]
    for role in labelled:
        cut |= _steps(table, role)
    time = table.columns.get("time")
    if time is not None and time.cells.dtype.kind == "f":
        restart = np.diff(time.cells) < 0
        for role in ("current", "voltage"):
            if role in table.columns:
                steps = _steps(table, role)
                commanded = bool(labelled) and steps.sum() * _FEWEST_ROWS <= count
                told_step = "kind" in table.columns and "current_step" in set(
                    map(str, table.columns["kind"].cells)
                )
                cut |= steps if commanded and not told_step else steps & restart
    if not cut.any():
        return [(None, None)]
    starts = np.concatenate([[0], np.flatnonzero(cut) + 1])
    if len(starts) * _FEWEST_ROWS > count:
        raise DataError(
            f"conditions change {len(starts) - 1} times in {count} rows: the tests cannot be told "
            "apart",
            where=f"{where}, {table.place(int(starts[1]))}",
            advice="Sort the table by test, or add a column `test` that names each row's test",
        )
    pieces = np.split(np.arange(count), starts[1:])
    return [(_condition_label(table, int(piece[0])), piece) for piece in pieces]


def _steps(table: RawTable, role: str) -> NDArray[np.bool_]:
    cells = table.columns[role].cells
    return np.asarray(cells[1:] != cells[:-1], dtype=bool)


def _condition_label(table: RawTable, row: int) -> str | None:
    """A name for a test in a long table, as file names tell conditions: ``10mm_2Hz_0.5A``."""
    words = []
    for role, factor, symbol in (
        ("amplitude", 1e3, "mm"), ("frequency", 1.0, "Hz"), ("current", 1.0, "A"),
        ("voltage", 1.0, "V"),
    ):  # fmt: skip
        column = table.columns.get(role)
        if column is None or column.cells.dtype.kind != "f" or column.unit is None:
            continue
        words.append(f"{float(to_si(column.cells[row], column.unit)) * factor:.6g}{symbol}")
    return "_".join(words) or None


def _told(table: RawTable, where: str) -> dict[str, object]:
    told: dict[str, object] = {}
    for role in (*LABELS, "kind", "run_order"):
        column = table.columns.get(role)
        if column is None or not len(column.cells):
            continue
        if bool(np.any(column.cells[1:] != column.cells[:-1])):
            continue
        value = column.cells[0]
        place = f"{where}, {table.place(0)}, column {column.header!r}"
        if role == "kind":
            told[role] = str(value).strip()
            continue
        if not isinstance(value, float) or not np.isfinite(value):
            raise DataError(f"{role} is not a number: {str(value)[:40]!r}", where=place)
        if role == "run_order":
            told[role] = int(value)
            continue
        if column.unit is None:
            raise DataError(
                f"no unit is given for {role}",
                where=place,
                advice="Write it into the header, for example "
                f"{'amplitude_mm' if unit_quantity(role) == 'displacement' else 'frequency_Hz'}",
            )
        told[role] = float(to_si(value, column.unit))
    return told
