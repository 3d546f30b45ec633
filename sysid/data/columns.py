"""What a column's header says: which quantity, in which unit.

Headers are understood in the forms ``force_N``, ``force [N]`` and ``force (N)``, with the unit
left out where a units row or the manifest gives it.  Nothing is guessed: a header that is neither
of these forms nor named in the manifest is not read, and that is said.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from sysid.data.advice import column_line, into_manifest
from sysid.errors import DataError, UnitError
from sysid.units import Unit, find_unit

MEASURED: Final[tuple[str, ...]] = (
    "time", "displacement", "velocity", "force", "current", "voltage", "temperature",
)  # fmt: skip
"""Quantities that a column may record sample by sample."""

REQUIRED: Final[tuple[str, ...]] = ("time", "displacement", "force")
"""Without these a table is no test."""

LABELS: Final[dict[str, str]] = {"amplitude": "displacement", "frequency": "frequency"}
"""Conditions that a column may repeat on every row → the quantity of their unit."""

WORDS: Final[tuple[str, ...]] = ("test", "kind", "run_order")
"""Columns without a unit: the key of a test in a table of many, kind of excitation, order."""

_WORD_SPELLINGS: Final[dict[str, str]] = {
    "test": "test", "test_id": "test", "testid": "test", "kind": "kind", "run_order": "run_order",
}  # fmt: skip

_UNITED: Final[tuple[str, ...]] = (*MEASURED, *LABELS)

_NUMERIC: Final = frozenset("+-.,0123456789")

_BRACKETS: Final = re.compile(
    r"^(?P<name>[^\[\](){}（）]+?)\s*[\[(（](?P<unit>[^\[\]()（）]*)[\])）]$"
)


def unit_quantity(role: str) -> str:
    """The quantity whose units a role's numbers carry (an amplitude is a displacement)."""
    return LABELS.get(role, role)


@dataclass(frozen=True)
class Header:
    """A header taken apart.

    Attributes:
        role: One of `MEASURED`, `LABELS` or `WORDS`.
        unit: The symbol as written; None where the header has none.
    """

    role: str
    unit: str | None


def parse_header(text: str) -> Header | None:
    """Take a header apart; None where it is none of the known forms."""
    text = text.strip()
    if text[:1] in _NUMERIC:
        return None
    bracketed = _BRACKETS.match(text)
    if bracketed:
        role = _word(bracketed["name"])
        return Header(role, bracketed["unit"].strip() or None) if role in _UNITED else None
    word = _word(text)
    if word in _WORD_SPELLINGS:
        return Header(_WORD_SPELLINGS[word], None)
    for role in _UNITED:
        if word == role:
            return Header(role, None)
        if word.startswith(f"{role}_"):
            return Header(role, text[len(role) + 1 :])
    return None


def _word(text: str) -> str:
    return text.strip().lower().replace(" ", "_")


def _symbol(unit: str) -> str:
    """``mm_s`` means mm/s: variable names of MATLAB cannot hold a slash."""
    return unit.replace("_", "/") if unit.count("_") == 1 else unit


def known_unit(unit: str, quantity: str) -> bool:
    """Whether `unit` is a symbol of `quantity`."""
    try:
        find_unit(_symbol(unit), quantity)
    except UnitError:
        return False
    return True


@dataclass(frozen=True)
class Column:
    """A column of a file that has a meaning.

    Attributes:
        index: Position among the file's columns, from 0.
        header: As the file writes it.
        unit: Of the numbers; None for words, and where nothing says.
    """

    index: int
    header: str
    unit: Unit | None


@dataclass(frozen=True)
class Assignment:
    """Which column holds which quantity.

    Attributes:
        columns: Role → column.
        unread: Headers that have no meaning here, in the file's order.
        notes: What the user should know, one sentence each.
    """

    columns: Mapping[str, Column]
    unread: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Naming:
    """How columns are named in a campaign.

    Attributes:
        named: Role → (header, unit symbol or None), from the manifest; the rest is recognised.
    """

    named: Mapping[str, tuple[str, str | None]] = field(default_factory=dict)

    def recognised(self, cells: Sequence[str]) -> set[str]:
        """The roles that a line would have if it were the header."""
        cells = [cell.strip() for cell in cells]
        roles = {role for role, (header, _) in self.named.items() if header in cells}
        for cell in cells:
            header = parse_header(cell)
            if header and header.role not in self.named and self._has_sense(header):
                roles.add(header.role)
        return roles

    @staticmethod
    def _has_sense(header: Header) -> bool:
        return header.unit is None or known_unit(header.unit, unit_quantity(header.role))

    def assign(
        self, headers: Sequence[str], units: Sequence[str | None] | None, where: str
    ) -> Assignment:
        """Give every header its meaning.

        Args:
            headers: Of one table, in order.
            units: What the file itself says about units apart from the headers (a units row,
                channel properties), one per header.
            where: The file, for errors.

        Raises:
            DataError: A column that the manifest names is missing, or two columns claim one role.
            UnitError: A unit is not known.
        """
        headers = [header.strip() for header in headers]
        beside = list(units) if units is not None else [None] * len(headers)
        columns: dict[str, Column] = {}
        notes: list[str] = []
        for role, (name, unit) in self.named.items():
            index = _position(headers, name, role, where)
            columns[role] = _column(role, index, headers, unit, beside[index], where, notes)
        taken = {column.index for column in columns.values()}
        for role, found in self._candidates(headers, taken).items():
            sound = [i for i in found if self._has_sense(_parsed(headers[i]))] or found
            if len(sound) > 1:
                raise _both(role, [headers[i] for i in sound], bool(self.named), where)
            index = sound[0]
            columns[role] = _column(role, index, headers, None, beside[index], where, notes)
        used = {column.index for column in columns.values()}
        last = max(used, default=-1)
        unread = tuple(
            header or f"(column {i + 1}, no name)"
            for i, header in enumerate(headers)
            if i not in used and (header or i < last)
        )
        return Assignment(columns, unread, tuple(notes))

    def _candidates(self, headers: Sequence[str], taken: set[int]) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for index, text in enumerate(headers):
            header = parse_header(text)
            if header and index not in taken and header.role not in self.named:
                found.setdefault(header.role, []).append(index)
        return found


def _both(role: str, names: Sequence[str], has: bool, where: str) -> DataError:
    """Several columns hold one quantity."""
    told = " and ".join(repr(name) for name in names)
    if len(set(names)) < len(names):
        advice = f"Rename them, so that one of them is {role}"
    else:
        line = column_line(role, names[0], _parsed(names[0]).unit)
        told_where = into_manifest("columns", line, has=has)
        advice = f"Say which one counts: if it is {names[0]!r}, {told_where}"
    return DataError(
        f"columns {told} {'both' if len(names) == 2 else 'all'} hold {role}",
        where=where,
        advice=advice,
    )


def _parsed(text: str) -> Header:
    header = parse_header(text)
    assert header is not None
    return header


def _position(headers: Sequence[str], name: str, role: str, where: str) -> int:
    count = headers.count(name)
    if count == 1:
        return headers.index(name)
    if count > 1:
        raise DataError(
            f"{count} columns are called {name!r}",
            where=where,
            advice=f"Rename them, so that one of them is {role}",
        )
    raise DataError(
        f"column {name!r} is missing, which the manifest names as {role}",
        where=where,
        advice=f"The file has: {listed(headers)}",
    )


def _column(
    role: str,
    index: int,
    headers: Sequence[str],
    said: str | None,
    beside: str | None,
    where: str,
    notes: list[str],
) -> Column:
    """The column with its unit: the manifest's word first, then the header, then beside it."""
    name = headers[index]
    if role in WORDS:
        return Column(index, name, None)
    parsed = parse_header(name)
    own = parsed.unit if parsed is not None and parsed.role == role else None
    place = f"{where}, column {name!r}"
    quantity = unit_quantity(role)
    if said is None and own is not None and beside is not None:
        _need_same_unit(own, beside, quantity, place)
    own = own or beside
    if said is None:
        unit = None if own is None else find_unit(_symbol(own), quantity, where=place)
        return Column(index, name, unit)
    unit = find_unit(said, quantity, where=place)
    if own is not None and known_unit(own, quantity) and find_unit(_symbol(own), quantity) != unit:
        notes.append(f"{place}: the file says {own!r}, the manifest {said!r}; {said!r} is taken")
    return Column(index, name, unit)


def _need_same_unit(own: str, beside: str, quantity: str, place: str) -> None:
    """Refuse a header that names one unit above a row, or a property, that names another."""
    if not (known_unit(own, quantity) and known_unit(beside, quantity)):
        return
    if find_unit(_symbol(own), quantity) != find_unit(_symbol(beside), quantity):
        raise DataError(
            f"the header says {own!r}, the unit given beside it is {beside!r}",
            where=place,
            advice="Correct one of them, or name the unit in campaign.toml",
        )


def listed(headers: Sequence[str], most: int = 12) -> str:
    """Headers as a list for a message, cut where it gets long."""
    shown = [repr(h[:40]) for h in headers if h][:most]
    more = sum(1 for h in headers if h) - len(shown)
    return (", ".join(shown) or "no named columns") + (f" and {more} more" if more > 0 else "")
