"""Named variables, structs and groups → tables, for formats that are trees (``.mat``).

A tree is a dict (struct), a list (struct array, cell), a number array, or text.  A dict with
columns for a test in it is a table; every dict below it is looked at too.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from sysid.data.columns import LABELS, MEASURED, REQUIRED, WORDS, Naming, listed
from sysid.data.readers.base import (
    FEWEST_ROWS,
    Cells,
    RawColumn,
    RawTable,
    as_cells,
    is_partial,
    like_a_test,
    only_tests,
    with_beside,
)
from sysid.errors import DataError

Tree = object

_DEEPEST = 8


def tables_from_tree(
    tree: Mapping[str, Tree], naming: Naming, path: Path, kind: str
) -> tuple[RawTable, ...]:
    """Find every table of a tree.

    Args:
        tree: The file's variables.
        naming: How columns are named.
        path: For messages.
        kind: Format, for messages.

    Raises:
        DataError: There is none, or columns of one table differ in length.
    """
    found = [
        (part, fields)
        for part, fields in _dicts(tree, "", 0)
        if len(naming.recognised(list(fields)) & set(REQUIRED)) >= 2
    ]
    if not found:
        raise DataError(
            f"{kind} file has no variables or structs with time, displacement and force",
            where=path,
            advice=f"It holds {listed(list(_paths(tree, '', 0)))}. Name variables or fields like "
            "time_s, displacement_mm, force_N, or name them in campaign.toml under [columns]",
        )
    partial = {part for part, columns in found if is_partial(naming.recognised(list(columns)))}
    found = only_tests(
        found,
        lambda part: naming.recognised(list(part[1])),
        lambda part: _has_spare(part[1], naming),
    )
    alone = len(found) == 1
    names = {part for part, _ in found}
    told = [
        f"{part or 'top'} is not read: of {listed(list(columns))}, not all of time, "
        "displacement and force are named. If it is a test, name its fields so, or name them in "
        "campaign.toml under [columns]"
        for part, columns in _dicts(tree, "", 0)
        if part not in names and (part in partial or like_a_test(list(_sizes(columns).values())))
    ]
    tables = [
        table_from_columns(fields, naming, path, None if alone else part or "top", {})
        for part, fields in found
    ]
    return with_beside(tables, told)


def _sizes(columns: Mapping[str, Tree]) -> dict[str, int]:
    """Count of numbers of every array that holds some."""
    return {
        name: v.size
        for name, v in columns.items()
        if isinstance(v, np.ndarray) and v.dtype.kind in "fiu"
    }


def _has_spare(columns: Mapping[str, Tree], naming: Naming) -> bool:
    """Whether an array as long as the longest has a name without a meaning."""
    sizes = _sizes(columns)
    longest = max(sizes.values(), default=0)
    return longest >= FEWEST_ROWS and any(
        size == longest and not naming.recognised([name]) for name, size in sizes.items()
    )


def table_from_columns(
    fields: Mapping[str, Tree],
    naming: Naming,
    path: Path,
    part: str | None,
    units: Mapping[str, str],
    changes: Sequence[str] = (),
) -> RawTable:
    """Make a table of named arrays; a single value holds for every row.

    Args:
        fields: Name → array, number or text.
        naming: How columns are named.
        path: For messages.
        part: Which part of the file this is.
        units: Name → unit symbol, where the file states it beside the name.
        changes: What was done to them already.

    Raises:
        DataError: An array is not one column of real numbers, or lengths differ.
    """
    where = str(path) if part is None else f"{path}, {part}"
    names = list(fields)
    assignment = naming.assign(names, [units.get(name) for name in names], where)
    cells = {
        role: _cells(fields[names[column.index]], f"{where}, {column.header!r}")
        for role, column in assignment.columns.items()
    }
    rows = max((len(c) for role, c in cells.items() if role in REQUIRED), default=0)
    columns = {}
    for role, column in assignment.columns.items():
        values = cells[role]
        if len(values) == 1 and role in (*LABELS, *WORDS, *MEASURED[4:]):
            values = np.repeat(values, rows)
        if len(values) != rows:
            raise DataError(
                f"{column.header!r} has {len(values)} values, other columns {rows}",
                where=where,
                advice="Every column of a test needs as many values as its time",
            )
        columns[role] = RawColumn(column.header, column.unit, values)
    return RawTable(
        part,
        columns,
        np.arange(1, rows + 1),
        "sample",
        None,
        assignment.unread,
        tuple(changes),
        assignment.notes,
    )


def _cells(value: Tree, where: str) -> Cells:
    if isinstance(value, str):
        return as_cells([value])
    if not isinstance(value, np.ndarray):
        raise DataError("is no column of numbers", where=where)
    if value.ndim > 1 and max(value.shape, default=0) != value.size:
        shape = " × ".join(str(n) for n in value.shape)
        raise DataError(f"is no column of numbers but {shape}", where=where)
    flat = value.ravel()
    if flat.dtype.kind in "fiu":
        return flat.astype(np.float64)
    if flat.dtype.kind in "cb":
        name = "complex numbers" if flat.dtype.kind == "c" else "true and false"
        raise DataError(f"holds {name}, not numbers", where=where)
    return as_cells(flat.tolist())


def _dicts(tree: Tree, part: str, depth: int) -> Iterator[tuple[str, Mapping[str, Tree]]]:
    if depth > _DEEPEST:
        return
    if isinstance(tree, Mapping):
        yield part, {name: v for name, v in tree.items() if isinstance(v, (np.ndarray, str))}
        for name, value in tree.items():
            yield from _dicts(value, f"{part}.{name}" if part else name, depth + 1)
    elif isinstance(tree, list):
        for place, value in enumerate(tree, start=1):
            yield from _dicts(value, f"{part}({place})", depth + 1)


def _paths(tree: Tree, part: str, depth: int) -> Iterator[str]:
    if isinstance(tree, Mapping) and depth < _DEEPEST:
        for name, value in tree.items():
            yield from _paths(value, f"{part}.{name}" if part else str(name), depth + 1)
    elif part:
        yield part
