"""Excel workbooks by openpyxl; every sheet with a header for a test is a table."""

import io
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Final

from sysid.data.columns import REQUIRED, Naming
from sysid.data.readers.base import (
    FEWEST_ROWS,
    RawTable,
    Reader,
    guarded,
    is_partial,
    number,
    only_tests,
    with_beside,
)
from sysid.data.readers.grid import (
    HEADER_WITHIN,
    HeaderPlace,
    Row,
    find_header,
    likely_header,
    no_header,
    tables_from_rows,
)
from sysid.errors import DataError


def read_xlsx(
    data: bytes, path: Path, naming: Naming, encoding: str | None = None
) -> tuple[RawTable, ...]:
    """Read a workbook.  Formulas count with the values that Excel stored.

    Beside a sheet with a whole header, sheets without one are no tests, and are told of.

    Raises:
        DataError: The file is damaged, or no sheet holds a table that can be read.
    """
    del encoding
    sheets = _sheets(data, path)
    found = []
    seen: list[str] = []
    for title, rows in sheets:
        header = find_header([cells for _, cells in rows[:HEADER_WITHIN]], naming)
        if header is None:
            seen.extend(likely_header([cells for _, cells in rows[:HEADER_WITHIN]]))
        else:
            found.append((title, rows, header))
    if not found:
        if not any(rows for _, rows in sheets):
            raise DataError("is empty", where=path, advice="Export the file again, or remove it")
        raise no_header(path, seen, has=bool(naming.named))
    kept = only_tests(
        found,
        lambda sheet: naming.recognised(sheet[2].cells),
        lambda sheet: _has_spare(sheet[1], sheet[2], naming),
    )
    titles = {title for title, _, _ in kept}
    partial = {z for z, _, header in found if is_partial(naming.recognised(header.cells))}
    told = [
        f"sheet {title} is not read: no header there names time, displacement and force. If it is "
        "a test, name its columns so, or name them in campaign.toml under [columns]"
        for title, rows in sheets
        if title not in titles and (title in partial or _like_a_test(rows))
    ]
    tables: list[RawTable] = []
    for title, rows, header in kept:
        part = title if len(kept) > 1 else None
        tables.extend(tables_from_rows(rows, header, naming, path, part=part, row_word="row"))
    return with_beside(tables, told)


def _like_a_test(rows: Sequence[Row]) -> bool:
    return sum(count >= FEWEST_ROWS for count in _numbers(rows)) >= len(REQUIRED)


def _has_spare(rows: Sequence[Row], header: HeaderPlace, naming: Naming) -> bool:
    """Whether a column of numbers has a header without a meaning."""
    return any(
        count >= FEWEST_ROWS and text and not naming.recognised([text])
        for text, count in zip(header.cells, _numbers(rows[header.first_data :]), strict=False)
    )


def _numbers(rows: Sequence[Row]) -> list[int]:
    """How many numbers each column holds, among the rows that are looked at."""
    looked = [cells for _, cells in rows[:HEADER_WITHIN]]
    return [
        sum(cell not in (None, "") and number(cell) is not None for cell in column)
        for column in zip_longest(*looked)
    ]


def _sheets(data: bytes, path: Path) -> list[tuple[str, list[Row]]]:
    """Title and rows of every worksheet."""
    with guarded(path, "Excel"):
        from openpyxl import load_workbook

        book = load_workbook(io.BytesIO(data), read_only=True, data_only=True)
        try:
            return [
                (sheet.title, list(enumerate(sheet.iter_rows(values_only=True), start=1)))
                for sheet in book.worksheets
            ]
        finally:
            book.close()


XLSX: Final = Reader("Excel", (".xlsx", ".xlsm"), read_xlsx)
