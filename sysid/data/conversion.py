"""The rows of one test → a `Record` in SI with the program's signs; every change is said."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sysid.data.advice import (
    EXAMPLE_UNITS,
    column_line,
    into_manifest,
    known_units,
    proposed_columns,
)
from sysid.data.cells import cell_advice
from sysid.data.columns import MEASURED, REQUIRED, parse_header
from sysid.data.manifest import CampaignSection
from sysid.data.parts import TestTable
from sysid.data.readers.base import RawColumn, RawTable
from sysid.data.record import Conditions, Record, Source
from sysid.data.timebase import time_axis
from sysid.errors import DataError
from sysid.units import SI_SYMBOL, to_si

_LARGEST: Final = 1e15
"""Numbers beyond this, in any unit, are damage (time stamps in µs since 1970 are below it)."""


@dataclass(frozen=True)
class Origin:
    """Which file a test came from.

    Attributes:
        shown: The file's path for messages.
        file: Path relative to the campaign's folder.
        identity: Of its test: the file's name without its ending, or its path.
        sha256: Hash of the file.
    """

    shown: str
    file: str
    identity: str
    sha256: str


def make_record(
    test: TestTable,
    origin: Origin,
    signs: CampaignSection,
    *,
    flip_force: bool = False,
    manifest_names: bool = False,
) -> Record:
    """Convert one test.

    Args:
        test: Its rows.
        origin: Its file.
        signs: What positive numbers in the file mean.
        flip_force: Turn the force's sign besides.
        manifest_names: The manifest names columns already, for advice that can be pasted.

    Returns:
        The record, with what its columns tell as its nominal conditions (labels of the file's
        name and so on are not known here).

    Raises:
        DataError: A column is missing, a cell is no number, a row is not in order.
        UnitError: A unit is not known.
    """
    table = test.table
    _need_columns(table, origin.shown, manifest_names)
    changes = list(table.changes)
    values: dict[str, NDArray[np.float64]] = {}
    for role in MEASURED:
        column = table.columns.get(role)
        if column is None:
            continue
        if _unrecorded(role, column):
            changes.append(f"column {column.header!r} holds no number: {role} is not recorded")
            continue
        values[role] = in_si(role, column, table, origin.shown, changes)
    if len(values["time"]) < 2:
        raise DataError(
            f"holds {len(values['time'])} row(s) of data; a test needs many",
            where=_where(table, origin.shown),
            advice="Export the whole recording, or remove the file",
        )
    time, keep, said = time_axis(values.pop("time"), table, origin.shown)
    values = {role: array[keep] for role, array in values.items()}
    changes.extend(said)
    _turn_signs(values, signs, flip_force, changes)
    changes.extend(f"column {header!r} was not read" for header in table.unread)
    identity = origin.identity if test.part is None else f"{origin.identity}#{test.part}"
    return Record(
        id=identity,
        time=time,
        nominal=Conditions(),
        source=Source(origin.file, origin.sha256, test.part, tuple(changes)),
        **values,
    )


def _unrecorded(role: str, column: RawColumn) -> bool:
    """A test can do without the quantity, and not one cell holds a number."""
    blank = column.cells.dtype.kind == "f" and bool(np.isnan(column.cells).all())
    return blank and role not in REQUIRED


def _where(table: RawTable, file: str) -> str:
    return file if table.part is None else f"{file}, {table.part}"


def _need_columns(table: RawTable, file: str, has: bool) -> None:
    missing = [role for role in REQUIRED if role not in table.columns]
    if missing:
        have = [column.header for column in table.columns.values()]
        names = ", ".join(repr(h[:40]) for h in (*have, *table.unread[:12]))
        example = ", ".join(f"{role}_{EXAMPLE_UNITS[role]}" for role in missing)
        lines = proposed_columns([h[:40] for h in table.unread], missing)
        taken = [
            f"Its column {column.header!r} is named as {role} in campaign.toml: correct that if it "
            f"holds {header.role}. "
            for role, column in table.columns.items()
            if (header := parse_header(column.header)) is not None
            and header.role in missing
            and role != header.role
        ]
        raise DataError(
            f"has no column for {' and '.join(missing)}",
            where=_where(table, file),
            advice=f"{''.join(taken)}Its columns are: {names}. Name it like {example}, or "
            + into_manifest("columns", *lines, has=has),
        )
    for role in MEASURED:
        column = table.columns.get(role)
        if column is not None and column.unit is None and not _unrecorded(role, column):
            raise DataError(
                f"no unit is given for {role}",
                where=f"{_where(table, file)}, column {column.header!r}",
                advice=f"Write it into the header, for example {role}_{EXAMPLE_UNITS[role]}, if "
                f"that is what the numbers are in ({known_units(role)} are known), or "
                + into_manifest("columns", column_line(role, column.header, "…"), has=has),
            )


def in_si(
    role: str, column: RawColumn, table: RawTable, file: str, changes: list[str]
) -> NDArray[np.float64]:
    """Convert one column.

    Args:
        role: Its quantity.
        column: As the file has it, with a unit.
        table: Its rows, for messages.
        file: The file, for messages.
        changes: Gets a sentence where the numbers change.

    Returns:
        [n] in SI (temperatures in °C).

    Raises:
        DataError: A cell is no number, empty, not finite, or larger than any measurement.
    """
    cells = column.cells
    if cells.dtype.kind != "f":
        row = next(i for i, cell in enumerate(cells) if not isinstance(cell, float))
        raise DataError(
            f"{role} is not a number: {str(cells[row])[:40]!r}",
            where=f"{file}, {table.place(row)}, column {column.header!r}",
            advice=cell_advice(role, cells[row]),
        )
    bad = ~np.isfinite(cells)
    if bad.any():
        row, count = int(np.argmax(bad)), int(bad.sum())
        more = "" if count == 1 else f" (as in {count} rows)"
        raise DataError(
            f"{role} is empty or not a finite number{more}",
            where=f"{file}, {table.place(row)}, column {column.header!r}",
            advice="Fill the cell or remove the row; nothing is filled in here",
        )
    assert column.unit is not None
    symbol = SI_SYMBOL[role]
    if column.unit.symbol != symbol:
        changes.append(f"{role} converted from {column.unit.symbol} to {symbol}")
    large = np.abs(cells) > _LARGEST
    if large.any():
        row = int(np.argmax(large))
        raise DataError(
            f"{role} is {cells[row]:.3g} {column.unit.symbol}, which no rig measures",
            where=f"{file}, {table.place(row)}, column {column.header!r}",
            advice="Correct the cell, or remove the row",
        )
    return to_si(cells, column.unit)


def _turn_signs(
    values: dict[str, NDArray[np.float64]],
    signs: CampaignSection,
    flip_force: bool,
    changes: list[str],
) -> None:
    if signs.positive_displacement == "extension":
        for role in ("displacement", "velocity"):
            if role in values:
                values[role] = -values[role]
                changes.append(f"sign of {role} turned: the manifest says extension is positive")
    if signs.positive_force == "extension":
        values["force"] = -values["force"]
        changes.append("sign of force turned: the manifest says extension is positive")
    if flip_force:
        values["force"] = -values["force"]
        changes.append("sign of force turned: asked for by --flip-force")
