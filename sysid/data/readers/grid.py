"""Rows of cells → tables: header, units row, preamble, start/resume blocks.

Text that is no plain table and spreadsheets come through here cell by cell.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from sysid.data.advice import into_manifest, proposed_columns
from sysid.data.columns import REQUIRED, WORDS, Assignment, Naming, listed
from sysid.data.readers.base import RawColumn, RawTable, as_cells, number
from sysid.errors import DataError
from sysid.units import UNITS

Cell = object
Row = tuple[int, Sequence[Cell]]
"""Where a row stands (from 1), and its cells."""

HEADER_WITHIN: Final = 2000
"""Rows among which the header is looked for."""

_MARKER: Final = re.compile(r"\b(re)?(start|sum|continu|paus|stop|end)\w*\b", re.IGNORECASE)
_FAILED: Final = re.compile(r"#(?:N/?[AV]|NAN|INF|IND|[^\W\d_]+(?:/0)?[!?])", re.IGNORECASE)
"""What spreadsheets write where a formula failed, in some language: ``#N/A``, ``#WERT!``."""
_DASH: Final = ("", "-", "–", "1")


@dataclass(frozen=True)
class HeaderPlace:
    """The header that was found.

    Attributes:
        index: Of the row among the rows looked at.
        cells: Its cells as text.
        units: Cells of the units row below it, or None.
    """

    index: int
    cells: tuple[str, ...]
    units: tuple[str | None, ...] | None

    @property
    def first_data(self) -> int:
        """Index of the first row below header and units row."""
        return self.index + (1 if self.units is None else 2)


def text_of(cell: Cell) -> str:
    """A cell as text, empty where there is nothing."""
    return "" if cell is None else str(cell).strip()


def find_header(rows: Sequence[Sequence[Cell]], naming: Naming) -> HeaderPlace | None:
    """The row that names most quantities (the first of equals); None where none names any."""
    best, most = None, 0
    for index, cells in enumerate(rows):
        texts = [text_of(cell) for cell in cells]
        roles = naming.recognised(texts)
        if len(roles) > most:
            best, most = index, len(roles)
            if roles.issuperset(REQUIRED):
                break
    if best is None:
        return None
    headers = tuple(text_of(cell) for cell in rows[best])
    below = rows[best + 1] if best + 1 < len(rows) else ()
    return HeaderPlace(best, headers, _units_row(below, len(headers)))


def _units_row(cells: Sequence[Cell], width: int) -> tuple[str | None, ...] | None:
    """The cells of a row as unit symbols, if that is what they are."""
    symbols = [text_of(cell).strip("[]()").strip() for cell in cells][:width]
    named = [symbol for symbol in symbols if symbol not in _DASH]
    if not named or any(number(symbol) is not None for symbol in named):
        return None
    if not any(_is_symbol(symbol) for symbol in named):
        return None
    padded = symbols + [""] * (width - len(symbols))
    return tuple(None if symbol in _DASH else symbol for symbol in padded)


def _is_symbol(text: str) -> bool:
    return any(text == unit.symbol for unit in UNITS) or text in ("°C", "°F", "sec", "Sec")


def likely_header(rows: Sequence[Sequence[Cell]]) -> list[str]:
    """The words above the first row of numbers, units left out; of rows without such, the first.

    Only messages show it: what columns mean is never told from it.
    """
    filled = [[text for cell in cells if (text := text_of(cell))] for cells in rows]
    for place, texts in enumerate(filled):
        if sum(any(number(text, sign) is not None for sign in ".,") for text in texts) < 3:
            continue
        above = [words for words in filled[:place] if words][-2:][::-1]
        names = [words for words in above if len(words) >= 3]
        if names and len(names) == 2 and _units_row(names[0], len(names[0])) is not None:
            return names[1]
        return names[0] if names else texts
    return next((texts for texts in filled if texts), [])


def no_header(path: Path, seen: Sequence[str], *, has: bool = False) -> DataError:
    """The error for a file in which no header was found.

    Args:
        path: The file.
        seen: Cells of the row that is most like a header.
        has: The manifest names columns already.
    """
    names = [text for text in seen if number(text) is None]
    lines = proposed_columns(names, REQUIRED)
    told = into_manifest("columns", *lines, has=has)
    return DataError(
        "has no header with columns for time, displacement and force",
        where=path,
        advice=(
            f"Its first rows hold {listed(seen)}. If it is no test, move it elsewhere; else write "
            "headers like time_s, displacement_mm, force_N, with the units of the numbers, "
            + (f"or {told}" if names else "above them")
        ),
    )


def tables_from_rows(
    rows: Sequence[Row],
    header: HeaderPlace,
    naming: Naming,
    path: Path,
    *,
    part: str | None = None,
    row_word: str = "line",
    decimals: Sequence[str] = (".",),
) -> tuple[RawTable, ...]:
    """Cut the rows below a header into blocks and make a table of each.

    Args:
        rows: Every row of the file or sheet, blank ones too.
        header: Where the header is among them.
        naming: How columns are named.
        path: For messages.
        part: Sheet, where the file has several.
        row_word: What a row is called in messages.
        decimals: Decimal signs to choose from; the one that leaves fewer cells unread is taken.

    Raises:
        DataError: A row is ragged, or text stands between the numbers.
    """
    where = str(path) if part is None else f"{path}, {part}"
    assignment = naming.assign(header.cells, header.units, where)
    cutter = _Cutter(header, assignment, where, row_word)
    blocks = cutter.blocks(rows)
    tables = []
    for count, (block, remarks) in enumerate(blocks, start=1):
        numeric = [c.index for role, c in assignment.columns.items() if role not in WORDS]
        decimal = _decimal(block, numeric, decimals)
        columns = {
            role: RawColumn(c.header, c.unit, as_cells(_pick(block, c.index), decimal))
            for role, c in assignment.columns.items()
        }
        tables.append(
            RawTable(
                part,
                columns,
                np.array([place for place, _ in block], dtype=np.int_),
                row_word,
                count if len(blocks) > 1 else None,
                assignment.unread,
                tuple(remarks),
                assignment.notes,
            )
        )
    return tuple(tables)


def _pick(block: Sequence[Row], index: int) -> list[Cell]:
    return [cells[index] if index < len(cells) else None for _, cells in block]


def _decimal(block: Sequence[Row], indices: Sequence[int], decimals: Sequence[str]) -> str:
    """The one decimal sign that leaves fewest cells of a block unread (the first of equals)."""
    if len(decimals) == 1:
        return decimals[0]
    return min(
        decimals,
        key=lambda sign: sum(
            number(cell, sign) is None for index in indices for cell in _pick(block, index)
        ),
    )


def _is_comment(cells: Sequence[Cell], width: int) -> bool:
    """Whether a row begins with a comment's sign, and is no row of data whose formula failed.

    One word that looks like a failed formula, alone on its row, is a comment: `#Achtung!`.
    """
    filled = [text for cell in cells if (text := text_of(cell))]
    if not filled or not filled[0].startswith(("#", "%")):
        return False
    failed = _FAILED.fullmatch(filled[0]) and len(cells) >= width and len(filled) > 1
    return not failed


Block = tuple[list[Row], list[str]]


class _Cutter:
    """Goes down the rows once and sorts them into blocks."""

    def __init__(
        self, header: HeaderPlace, assignment: Assignment, where: str, row_word: str
    ) -> None:
        self.header = header
        self.used = [column.index for column in assignment.columns.values()]
        self.where = where
        self.row_word = row_word

    def blocks(self, rows: Sequence[Row]) -> list[Block]:
        """Blocks of data rows, each with remarks on rows left out."""
        blocks: list[Block] = [([], [])]
        texts: list[Row] = []
        skip_units = False
        for place, cells in rows[self.header.first_data :]:
            if all(text_of(cell) == "" for cell in cells):
                continue
            if skip_units:
                skip_units = False
                if _units_row(cells, len(self.header.cells)) == self.header.units:
                    continue
            if tuple(text_of(cell) for cell in cells) == self.header.cells:
                blocks.append(([], self._remarks(texts)))
                texts, skip_units = [], self.header.units is not None
            elif _is_comment(cells, len(self.header.cells)):
                blocks[-1][1].extend(self._remarks([(place, cells)]))
            elif self._is_text(cells):
                texts.append((place, cells))
            else:
                if texts:
                    self._need_markers(texts)
                    blocks.append(([], self._remarks(texts)))
                    texts = []
                self._need_width(place, cells)
                blocks[-1][0].append((place, cells))
        if texts:
            self._need_markers(texts)
            blocks[-1][1].extend(self._remarks(texts))
        return [block for block in blocks if block[0]] or blocks[:1]

    def _is_text(self, cells: Sequence[Cell]) -> bool:
        """A line of words, or of another layout that begins with a word."""
        filled = [text_of(cell) for cell in cells if text_of(cell)]
        numeric = [any(number(cell, sign) is not None for sign in ".,") for cell in filled]
        if not any(numeric):
            return len(filled) < len(self.header.cells)
        return not numeric[0] and len(cells) != len(self.header.cells)

    def _need_markers(self, texts: Sequence[Row]) -> None:
        """Words between numbers must be a comment or say that the recording stops or resumes."""
        for place, cells in texts:
            line = " ".join(text_of(cell) for cell in cells).strip()
            if not _MARKER.search(line):
                raise DataError(
                    f"text stands where numbers should be: {line[:60]!r}",
                    where=f"{self.where}, {self.row_word} {place}",
                    advice="Correct or remove it (a comment starts with #)",
                )

    def _need_width(self, place: int, cells: Sequence[Cell]) -> None:
        wide = len(self.header.cells)
        where = f"{self.where}, {self.row_word} {place}"
        if any(text_of(cell) for cell in cells[wide:]):
            advice = "Remove the extra cells or name them in the header"
            if len(cells) == 2 * wide:
                advice = "With a decimal comma, separate the columns by semicolon or tab"
            raise DataError(
                f"has {len(cells)} cells, the header {wide}", where=where, advice=advice
            )
        if max(self.used, default=-1) >= len(cells):
            raise DataError(
                f"has {len(cells)} cells, the header {wide}",
                where=where,
                advice="The line is cut short: export the file again, or remove the line",
            )

    def _remarks(self, texts: Sequence[Row]) -> list[str]:
        return [
            f"{self.row_word} {place} is not data and was not read: "
            f"{' '.join(text_of(cell) for cell in cells).strip()[:60]!r}"
            for place, cells in texts
        ]
