"""What every reader returns, and what it must not let through.

A reader takes the bytes of one file and gives one `RawTable` a test or block: columns that have a
meaning, in the file's own units.  Whatever a foreign library raises on a damaged file becomes one
`DataError`.
"""

import re
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from sysid.data.columns import REQUIRED, Naming
from sysid.errors import DataError, SysidError
from sysid.units import Unit

_FORTRAN: Final = re.compile(r"(?<=[\d.,])[Dd](?=[+-]?\d+$)")
"""How Fortran writes the exponent of a number in double precision."""

FEWEST_ROWS: Final = 8
"""Numbers in a column below which it is no recording."""

Part = TypeVar("Part")
Cells = NDArray[Any]
"""Numbers, or what the file holds where not every cell is a number."""


@dataclass(frozen=True)
class RawColumn:
    """One column with a meaning, as the file has it.

    Attributes:
        header: As the file writes it.
        unit: Of the numbers; None where nothing says.
        cells: [n] numbers (NaN where empty), or objects where a cell is no number.
    """

    header: str
    unit: Unit | None
    cells: Cells


@dataclass(frozen=True)
class RawTable:
    """One table or block of a file.

    Attributes:
        part: Which part of the file (sheet, group, struct); None where the file is one table.
        columns: Role (a quantity, a condition, ``test``, …) → column; all of one length.
        rows: [n] where each row stands, in `row_word`s from 1.
        row_word: ``"line"``, ``"row"`` or ``"sample"``.
        block: Number of the block, from 1, where a text file was started and resumed.
        unread: Headers without a meaning.
        changes: What was done to the rows, one sentence each.
        notes: What the user should know, one sentence each.
        beside: What is in the file beside its tests, one sentence each, without the file's name:
            it may hold of every file of a campaign.
    """

    part: str | None
    columns: Mapping[str, RawColumn]
    rows: Sequence[int] | NDArray[np.int_]
    row_word: str = "sample"
    block: int | None = None
    unread: tuple[str, ...] = ()
    changes: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=())
    beside: tuple[str, ...] = ()

    def place(self, row: int) -> str:
        """Where a row (index from 0) stands, for a message."""
        part = "" if self.part is None else f"{self.part}, "
        return f"{part}{self.row_word} {int(self.rows[row])}"


@dataclass(frozen=True)
class Reader:
    """One file format.

    Attributes:
        name: For messages.
        suffixes: File endings, lower case.
        read: Bytes, file, naming of columns, text encoding (None: recognised) → tables.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[[bytes, Path, Naming, str | None], tuple[RawTable, ...]]


@contextmanager
def guarded(path: Path, name: str) -> Iterator[None]:
    """Turn whatever a foreign library raises on a file into one `DataError`.

    The libraries raise anything at all on damaged files (zlib, struct, key, memory errors), so
    the net is wide on purpose; nothing is passed over.

    Args:
        path: Of the file.
        name: Of its format.

    Raises:
        DataError: The file cannot be read, or the library for it is not installed.
    """
    try:
        with warnings.catch_warnings(record=True):
            warnings.simplefilter("always")
            yield
    except SysidError:
        raise
    except ImportError as cause:
        raise DataError(
            f"needs a library that is not installed to be read ({cause.name or cause})",
            where=path,
            advice='Install the readers with: pip install "sysid[formats]"',
        ) from cause
    except Exception as cause:
        said = " ".join(str(cause).split())[:160]
        raise DataError(
            f"is not a readable {name} file, or is cut short ({type(cause).__name__}: {said})",
            where=path,
            advice="Export or copy the file again",
        ) from cause


def only_tests(
    parts: Sequence[Part],
    roles: Callable[[Part], Collection[str]],
    spare: Callable[[Part], bool],
) -> tuple[Part, ...]:
    """Parts of a file that are tests: where one is whole, a summary beside it is none.

    Where no part has time, displacement and force, all stay, so that what they lack is said; so
    does one that has time and one of the others, and a column that may be the third.

    Args:
        parts: Of the file, each with some column of a test.
        roles: Quantities of a part's columns.
        spare: Whether a part has a column of numbers without a meaning.
    """
    if not any(set(REQUIRED) <= set(roles(part)) for part in parts):
        return tuple(parts)
    return tuple(
        part
        for part in parts
        if set(REQUIRED) <= set(roles(part)) or (is_partial(roles(part)) and spare(part))
    )


def is_partial(roles: Collection[str]) -> bool:
    """Whether columns are time and one more quantity of a test at least."""
    return "time" in roles and len(set(REQUIRED) & set(roles)) > 1


def like_a_test(sizes: Collection[int]) -> bool:
    """As many columns of one length as a test has, of as many numbers as one may have.

    Args:
        sizes: Count of numbers of every column.
    """
    longest = max(sizes, default=0)
    return longest >= FEWEST_ROWS and list(sizes).count(longest) >= len(REQUIRED)


def with_beside(tables: Sequence[RawTable], told: Sequence[str]) -> tuple[RawTable, ...]:
    """Tables of a file, the first with what is in the file beside them."""
    if not tables:
        return ()
    return (replace(tables[0], beside=tuple(told)), *tables[1:])


def as_cells(values: Sequence[object], decimal: str = ".") -> Cells:
    """Cells as numbers where every one is a number or empty; else a cell that is none stays."""
    numbers = [number(value, decimal) for value in values]
    if all(n is not None for n in numbers):
        return np.array(numbers, dtype=np.float64)
    out = np.empty(len(values), dtype=object)
    out[:] = [value if n is None else n for value, n in zip(values, numbers, strict=True)]
    return out


def number(cell: object, decimal: str = ".") -> float | None:
    """A cell as a number, NaN where it is empty, None where it is something else."""
    if cell is None:
        return float("nan")
    if isinstance(cell, (bool, np.bool_)):
        return None
    if isinstance(cell, (int, float, np.integer, np.floating)):
        try:
            return float(cell)
        except OverflowError:
            return None
    if not isinstance(cell, str):
        return None
    text = cell.strip()
    if not text:
        return float("nan")
    text = text.replace("\u2212", "-")  # the minus sign of typesetters and some exports
    if "D" in text or "d" in text:
        text = _FORTRAN.sub("E", text)
    if decimal != ".":
        if "." in text:
            return None
        text = text.replace(decimal, ".")
    if "_" in text:
        return None
    try:
        return float(text)
    except ValueError:
        return None
