"""Text: CSV with comma, semicolon, tab or blanks, decimal comma, preamble, DAQ blocks.

A plain table of numbers goes through pandas' C parser; anything else (blocks, comments, ragged
lines, and every fault) is gone through cell by cell, so that a message can name the line.
"""

import csv
import io
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from sysid.data.columns import REQUIRED, WORDS, Assignment, Naming
from sysid.data.readers.base import RawColumn, RawTable, Reader, number
from sysid.data.readers.decode import decode
from sysid.data.readers.grid import (
    HEADER_WITHIN,
    HeaderPlace,
    find_header,
    likely_header,
    no_header,
    tables_from_rows,
)
from sysid.errors import DataError

SEPARATORS: Final[tuple[str, ...]] = ("\t", ";", ",", " ")
"""Tried in this order; a blank means any run of blanks."""

_GROUPED: Final = re.compile(r"[+\-\u2212]?[1-9]\d{0,2},\d{3}")
"""A number whose comma may separate thousands: before three digits, and not behind a lone zero."""

_LONGEST_HEADER: Final = 100_000
_SHOWN: Final = 400
"""Characters of a line that a message is made from."""
_NEAR: Final = 50
"""Lines among which the header is looked for first."""
_BEGINS_NUMBER: Final = tuple("+-.,0123456789\u2212")


@dataclass(frozen=True)
class Layout:
    """How a text file is laid out.

    Attributes:
        separator: One of `SEPARATORS`.
        header: Where the header is, in lines.
    """

    separator: str
    header: HeaderPlace


def split_line(line: str, separator: str) -> list[str]:
    """Cells of one line; quotes keep separators together."""
    if separator == " ":
        return line.split()
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        return line.split(separator)


def find_layout(lines: list[str], naming: Naming, path: Path) -> Layout:
    """Find header and separator.

    Raises:
        DataError: No line names a quantity.
    """
    best = None
    for within in (_NEAR, HEADER_WITHIN):
        head = [line if len(line) < _LONGEST_HEADER else "" for line in lines[:within]]
        best = _best_layout(head, lines, naming)
        if best is not None and naming.recognised(best.header.cells).issuperset(REQUIRED):
            break
    if best is None:
        head = [line[:_SHOWN] for line in lines[:_NEAR]]
        # not every comma separates: a decimal one stands between digits beside other separators
        split = r"[\t;]" if any(mark in line for line in head for mark in "\t;") else r"[\t;,]"
        cells = likely_header([re.split(split, line) for line in head])
        raise no_header(path, cells, has=bool(naming.named))
    return best


def _best_layout(head: list[str], lines: list[str], naming: Naming) -> Layout | None:
    """The separator under which one line of `head` names most quantities."""
    best, most, nearest = None, 0, len(head)
    for separator in SEPARATORS:
        header = find_header([split_line(line, separator) for line in head[:nearest]], naming)
        if header is None or (separator == " " and _tears_names(header, lines)):
            continue
        roles = naming.recognised(header.cells)
        if len(roles) > most:
            best, most = Layout(separator, header), len(roles)
        if roles.issuperset(REQUIRED):
            nearest = min(nearest, header.index + 2)
    return best


def _tears_names(header: HeaderPlace, lines: list[str]) -> bool:
    """Whether blanks part the names of columns and not the columns: no row below is as long."""
    below = lines[header.first_data : header.first_data + _NEAR]
    widths = [len(line.split()) for line in below if line.lstrip()[:1] in _BEGINS_NUMBER]
    return max(widths, default=len(header.cells)) < len(header.cells)


def read_text(
    data: bytes, path: Path, naming: Naming, encoding: str | None = None
) -> tuple[RawTable, ...]:
    """Read a text file.

    Args:
        data: The whole file.
        path: For messages.
        naming: How columns are named.
        encoding: From the manifest; None: recognised.

    Returns:
        One table a start/resume block.

    Raises:
        DataError: The text is no table of numbers; the message names the line.
    """
    text = decode(data, path, encoding).rstrip()
    if not text:
        raise DataError("is empty", where=path, advice="Export the file again, or remove it")
    lines = text.split("\n")
    layout = find_layout(lines, naming, path)
    assignment = naming.assign(layout.header.cells, layout.header.units, str(path))
    _need_decimals(lines, layout, assignment, path)
    plain = _read_plain(lines, layout, assignment)
    if plain is not None:
        return (plain,)
    rows = [
        (place, split_line(line, layout.separator)) for place, line in enumerate(lines, start=1)
    ]
    decimals = (".", ",") if _may_hold_commas(lines, layout) else (".",)
    return tables_from_rows(rows, layout.header, naming, path, decimals=decimals)


def _may_hold_commas(lines: list[str], layout: Layout) -> bool:
    """Whether a comma may be in a number: it does not separate the cells, or they are quoted."""
    return layout.separator != "," or any('"' in line for line in lines[layout.header.first_data :])


def _need_decimals(lines: list[str], layout: Layout, assignment: Assignment, path: Path) -> None:
    """Refuse numbers whose commas may be decimal signs as well as separators of thousands.

    One number that is read tells which: a comma that cannot separate thousands, or a point.  (With
    a point the comma is no decimal sign, and the cell is refused where it is read.)
    """
    first = layout.header.first_data
    if not _may_hold_commas(lines, layout) or not _GROUPED.search("\n".join(lines[first:])):
        return
    used = [c.index for role, c in assignment.columns.items() if role not in WORDS]
    doubtful: tuple[int, str] | None = None
    for place, line in enumerate(lines[first:], start=first + 1):
        cells = split_line(line, layout.separator)
        for cell in (cells[i].strip() for i in used if i < len(cells)):
            if _GROUPED.fullmatch(cell):
                doubtful = doubtful or (place, cell)
            elif ("," in cell or "." in cell) and _is_number(cell):
                return
    if doubtful is None:
        return
    place, cell = doubtful
    raise DataError(
        f"{cell!r} may be {cell.replace(',', '')} or {cell.replace(',', '.')}: every "
        "comma stands before three digits, as separators of thousands do",
        where=f"{path}, line {place}",
        advice="Export without separators of thousands, or with more or fewer decimals",
    )


def _is_number(cell: str) -> bool:
    return any(number(cell, sign) is not None for sign in ".,")


def _read_plain(lines: list[str], layout: Layout, assignment: Assignment) -> RawTable | None:
    """The table by pandas' C parser, or None where it is not plain numbers throughout."""
    import pandas as pd

    width, separator = len(layout.header.cells), layout.separator
    body_lines = lines[layout.header.first_data :]
    body = "\n".join(body_lines)
    if not body or not _regular(body, len(body_lines), width, separator):
        return None
    decimal = "," if separator != "," and "," in body and "." not in body else "."
    texts = {c.index for role, c in assignment.columns.items() if role in WORDS}
    numbers = {c.index for c in assignment.columns.values()} - texts
    spare = int(separator != " " and body.count(separator) == len(body_lines) * width)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pandas 3.1 deprecates float_precision
            warnings.simplefilter("error", pd.errors.ParserWarning)
            frame = pd.read_csv(
                io.StringIO(body),
                sep=r"\s+" if separator == " " else separator,
                header=None,
                names=list(range(width + spare)),
                index_col=False,
                dtype={i: "float64" if i in numbers else "object" for i in range(width + spare)},
                decimal=decimal,
                quoting=csv.QUOTE_NONE,
                float_precision="round_trip",
                keep_default_na=False,
                na_values=[""],
                skip_blank_lines=False,
                skipinitialspace=True,
                low_memory=False,
                engine="c",
            )
    except (ValueError, OverflowError, pd.errors.ParserWarning):
        return None
    if len(frame) != len(body_lines) or not np.isfinite(frame[sorted(numbers)].to_numpy()).all():
        return None
    if spare and frame[width].notna().any():  # pyright: ignore[reportGeneralTypeIssues]
        return None
    columns = {
        role: RawColumn(c.header, c.unit, frame[c.index].to_numpy(copy=True))
        for role, c in assignment.columns.items()
    }
    first = layout.header.first_data + 1
    rows = np.arange(first, first + len(frame))
    return RawTable(None, columns, rows, "line", None, assignment.unread, (), assignment.notes)


def _regular(body: str, lines: int, width: int, separator: str) -> bool:
    """Every line may have as many cells as the header, or one empty one more."""
    if '"' in body:
        return False
    if separator == " ":
        return True
    return body.count(separator) in (lines * (width - 1), lines * width)


TEXT: Final = Reader("text", (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm"), read_text)
