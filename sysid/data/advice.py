"""What to write into `campaign.toml`, word for word, so that it can be pasted.

A table's name and its keys stand on lines of their own, as TOML demands.  What is proposed is
never read as if it had been said: it is for the user to check and to write down.
"""

import json
import re
from collections.abc import Sequence
from typing import Final

from sysid.errors import UnitError
from sysid.units import UNITS, find_unit

EXAMPLE_UNITS: Final[dict[str, str]] = {
    "time": "s", "displacement": "mm", "velocity": "mm/s", "force": "N", "current": "A",
    "voltage": "V", "temperature": "degC",
}  # fmt: skip
"""Quantity → the unit that examples are written in."""

OPEN: Final = "…"
"""Stands where only the user knows what belongs there."""

_UNIT_AT_END: Final = (
    re.compile(r"[\[({（［](?P<unit>[^\[\](){}（）［］]+)[\])}）］]\s*$"),
    re.compile(r"(?:[_/,]\s*|\s+(?:in\s+)?)(?P<unit>[^\s_,]+)\s*$"),
)
"""``Kraft [kN]``, any brackets; then ``Kraft_kN``, ``Kraft/kN``, ``Kraft, kN``, ``Kraft in kN``."""


def into_manifest(section: str, *lines: str, path: object = "campaign.toml", has: bool) -> str:
    """The end of a sentence: where to write, then the lines, each on its own.

    Args:
        section: Of the manifest, without brackets.
        lines: Keys with their values.
        path: The manifest.
        has: The section is there already; TOML refuses a second one of its name.
    """
    told = "\n".join(lines)
    if has:
        return f"write under [{section}] in {path}:\n{told}"
    return f"write into {path}:\n[{section}]\n{told}"


def column_line(role: str, header: str, unit: str | None) -> str:
    """One line under ``[columns]``."""
    said = "" if unit is None else f", unit = {quoted(unit)}"
    return f"{role} = {{ column = {quoted(header)}{said} }}"


def proposed_columns(headers: Sequence[str], roles: Sequence[str]) -> tuple[str, ...]:
    """Lines under ``[columns]`` for quantities that were not recognised.

    A header is put in where it is the only one with a unit of the quantity, or the only one that
    holds its name (``Axial Force``, its unit a row below), and `OPEN` elsewhere.
    """
    lines = []
    for role in roles:
        fitting = [(h, unit) for h in headers if (unit := _unit_of(h, role)) is not None]
        named = [h for h in headers if role in re.split(r"[\W_]+", h.lower())]
        if len(fitting) != 1 and len(named) == 1:
            fitting = [(named[0], _unit_of(named[0], role))]
        header, unit = fitting[0] if len(fitting) == 1 else (OPEN, EXAMPLE_UNITS[role])
        lines.append(column_line(role, header, unit))
    return tuple(lines)


def known_units(quantity: str) -> str:
    """Symbols of a quantity, for a message."""
    return ", ".join(unit.symbol for unit in UNITS if unit.quantity == quantity)


def quoted(text: str) -> str:
    """A string as TOML writes it."""
    return json.dumps(text, ensure_ascii=False)


def _unit_of(header: str, quantity: str) -> str | None:
    for form in _UNIT_AT_END:
        found = form.search(header.strip())
        if found:
            try:
                return find_unit(found["unit"], quantity).symbol
            except UnitError:
                continue
    return None
