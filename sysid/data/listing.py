"""`tests.csv`: one row a test, with what is known of it."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from sysid.data.columns import REQUIRED, parse_header, unit_quantity
from sysid.data.conditions import KINDS
from sysid.data.glance import first_lines
from sysid.data.readers.base import number
from sysid.data.readers.decode import decode
from sysid.data.readers.text import TEXT, split_line
from sysid.errors import DataError, ManifestError
from sysid.units import find_unit, to_si

LISTING: Final = "tests.csv"
_NUMBERS: Final = ("amplitude", "frequency", "current", "voltage", "temperature")
_TOLD: Final = (*_NUMBERS, "run_order", "kind")
"""What a column may tell of a test."""
_POSITIVE: Final = ("amplitude", "frequency")


@dataclass(frozen=True)
class Listing:
    """A `tests.csv` as read.

    Attributes:
        path: The file.
        tests: File (or ``file#part``) as listed → condition → value, SI.
        lines: File as listed → line in `tests.csv`.
        notes: What the user should know.
    """

    path: Path
    tests: Mapping[str, Mapping[str, object]]
    lines: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def read_listing(path: Path) -> Listing:
    """Read a `tests.csv`.

    Raises:
        ManifestError: It has no `file` column, lists a test twice, or a cell is not what its
            column says; the message names line and column.
        UnitError: A unit is not known.
    """
    try:
        text = decode(path.read_bytes(), path).rstrip("\n")
    except OSError as cause:
        raise ManifestError(f"cannot be read: {cause.strerror or cause}", where=path) from cause
    except DataError as cause:
        raise ManifestError(cause.what, where=path, advice="Save it as UTF-8") from cause
    lines = text.split("\n")
    heading = next((i for i, line in enumerate(lines) if line.strip()), None)
    if heading is None:
        raise ManifestError("is empty", where=path, advice="Write at least the header `file`")
    separator = next((s for s in ";\t" if s in lines[heading]), ",")
    headers = [cell.strip() for cell in split_line(lines[heading], separator)]
    headers = ["file" if text.lower() == "file" else text for text in headers]
    if headers.count("file") != 1:
        raise ManifestError(
            f"has {headers.count('file')} columns called 'file'",
            where=f"{path}, line {heading + 1}",
            advice="The header must hold `file` once; its other columns may be amplitude_mm, "
            "frequency_Hz, current_A, voltage_V, temperature_degC, run_order, kind",
        )
    columns, notes = _columns(headers, path, heading + 1)
    tests: dict[str, dict[str, object]] = {}
    places: dict[str, int] = {}
    for place, line in enumerate(lines[heading + 1 :], start=heading + 2):
        if not line.strip(f"{separator} "):
            continue
        cells = split_line(line, separator)
        if separator != ",":
            cells = [_with_point(cell) for cell in cells]
        name, told = _row(cells, headers, columns, f"{path}, line {place}")
        if name in tests:
            raise ManifestError(
                f"lists {name!r} twice, in lines {places[name]} and {place}", where=path
            )
        tests[name], places[name] = told, place
    _check_order(tests, places, path)
    return Listing(path, tests, places, tuple(notes))


def looks_like_listing(path: Path) -> bool:
    """Whether a text file begins as a `tests.csv` does.

    It has a column `file` and one of a condition, and none of a test.

    Args:
        path: Any file; what is no text, or cannot be read, is no listing.
    """
    if path.suffix.lower() not in TEXT.suffixes:
        return False
    line = next((line for line in first_lines(path) if line.strip()), "")
    for separator in ";\t,":
        cells = [cell.strip().lower() for cell in split_line(line, separator)]
        roles = {header.role for cell in cells if (header := parse_header(cell))}
        if "file" in cells and roles & set(_TOLD) and not roles & set(REQUIRED):
            return True
    return False


def of_another_name(path: Path, listing: Listing | None) -> ManifestError:
    """The error for a list of tests that stands among the tests.

    Args:
        path: Of the list.
        listing: The campaign's own, if there is one: nothing may be written over it.
    """
    if listing is not None:
        return ManifestError(
            f"is a second list of tests beside {listing.path}, and no test",
            where=path,
            advice="Move it elsewhere; what it says alone, write there",
        )
    return ManifestError(
        "lists tests, and is not read as a list under this name",
        where=path,
        advice=f"Rename it to {LISTING}, or move it elsewhere if it is not meant",
    )


Columns = dict[int, tuple[str, str | None]]
"""Index → condition, unit symbol."""


def _columns(headers: list[str], path: Path, line: int) -> tuple[Columns, list[str]]:
    columns: Columns = {}
    notes: list[str] = []
    for index, text in enumerate(headers):
        header = parse_header(text)
        if text == "file" or not text:
            continue
        if header is None or header.role not in _TOLD:
            notes.append(f"{path}: column {text!r} is not read")
            continue
        where = f"{path}, line {line}, column {text!r}"
        if header.role in (role for role, _ in columns.values()):
            raise ManifestError(f"a second column tells {header.role}", where=where)
        if header.role in _NUMBERS:
            if header.unit is None:
                raise ManifestError(
                    f"no unit is given for {header.role}",
                    where=where,
                    advice="Write for example amplitude_mm, frequency_Hz, current_A",
                )
            find_unit(header.unit, unit_quantity(header.role), where=where)
        columns[index] = (header.role, header.unit)
    return columns, notes


def _row(
    cells: list[str], headers: list[str], columns: Columns, where: str
) -> tuple[str, dict[str, object]]:
    if any(cell.strip() for cell in cells[len(headers) :]):
        raise ManifestError(
            f"has {len(cells)} cells, the header {len(headers)}",
            where=where,
            advice="Remove the extra cells, or name them in the header (with a decimal comma, "
            "separate the columns by semicolon)",
        )
    cells = cells[: len(headers)]
    cells = [cell.strip() for cell in cells] + [""] * (len(headers) - len(cells))
    name = cells[headers.index("file")].replace("\\", "/").removeprefix("./")
    if not name:
        raise ManifestError("names no file", where=where)
    told: dict[str, object] = {}
    for index, (role, unit) in columns.items():
        if cells[index]:
            told[role] = _value(role, unit, cells[index], f"{where}, column {headers[index]!r}")
    return name, told


def _with_point(cell: str) -> str:
    """A number with a decimal comma as one with a point; anything else as it is."""
    return cell.replace(",", ".") if re.fullmatch(r"\s*[+-]?\d+,\d+\s*", cell) else cell


def _value(role: str, unit: str | None, cell: str, where: str) -> object:
    if role == "kind":
        if cell not in KINDS:
            raise ManifestError(
                f"kind {cell!r} is not known", where=where, advice=f"Kinds: {', '.join(KINDS)}"
            )
        return cell
    value = number(cell)
    if value is None or not abs(value) < float("inf"):
        raise ManifestError(f"{cell!r} is not a number", where=where)
    if role == "run_order":
        if value != int(value) or value < 1:
            raise ManifestError(f"run_order {cell!r} is not a whole number from 1", where=where)
        return int(value)
    if role in _POSITIVE and value < 0:
        raise ManifestError(f"{role} {cell!r} is negative", where=where)
    assert unit is not None
    return float(to_si(value, find_unit(unit, unit_quantity(role))))


def _check_order(
    tests: Mapping[str, Mapping[str, object]], places: Mapping[str, int], path: Path
) -> None:
    seen: dict[object, str] = {}
    for name, told in tests.items():
        order = told.get("run_order")
        if order is None:
            continue
        if order in seen:
            raise ManifestError(
                f"run_order {order} is given to {seen[order]!r} and {name!r}",
                where=f"{path}, line {places[name]}",
                advice="Every test has its own position in the campaign",
            )
        seen[order] = name
