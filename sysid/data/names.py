"""Conditions from file names: ``12.5mm_1.5Hz_0.2A_40C_run3.csv``, ``25mm0x25Hz_1A.csv``.

Without a pattern, every part of the name between underscores, blanks or hyphens that consists of
numbers with units is understood; ``x`` or a comma may stand for the decimal point (an underscore
may, too, or part a number from another: such a value is told of and not taken).  With a pattern
from the manifest (``{amplitude}mm{frequency}Hz_{current}A``) only the pattern counts.
"""

import re
import string
from dataclasses import dataclass
from typing import Final

from sysid.data.name_spellings import (
    NUMBER,
    QUANTITIES,
    SYMBOLS,
    decimal_or_index,
    is_near,
    respelled,
    symbols,
)
from sysid.errors import ManifestError
from sysid.units import find_unit, to_si

_PAIR: Final = re.compile(rf"({NUMBER})({SYMBOLS})(?![A-Za-z°])")


def _value(number: str, symbol: str, condition: str) -> float:
    unit = find_unit(symbol, QUANTITIES[condition])
    return float(to_si(float(number.replace("x", ".").replace(",", ".")), unit))


def conditions_in_name(stem: str) -> tuple[dict[str, float], tuple[str, ...]]:
    """Conditions that a file's stem tells, by the default reading.

    Args:
        stem: File name without its ending.

    Returns:
        Condition → SI value (°C for temperature), and sentences on what was not taken, without
        the stem: they may hold for many names.
    """
    found: dict[str, list[float]] = {}
    text, notes = respelled(stem)
    unread: list[str] = []
    text = decimal_or_index(text, notes)
    for token in re.split(r"[_\s]+|(?<=[A-Za-z])(?<!\d[eE])[-,]", text):
        pairs = list(_PAIR.finditer(token))
        if not pairs:
            unread.append(token)
            continue
        if "".join(pair[0] for pair in pairs) != token:
            notes.append(f"{token!r} in the name is no number with a unit; not taken")
            continue
        for pair in pairs:
            condition = next(c for c in QUANTITIES if pair[2] in symbols(c))
            found.setdefault(condition, []).append(_value(pair[1], pair[2], condition))
    notes.extend(
        f"{token!r} in the name is nearly a number with a unit; not taken"
        for token in unread
        if is_near(token, others=bool(found))
    )
    notes.extend(
        f"the name tells {condition} {len(values)} times, differently; none is taken"
        for condition, values in found.items()
        if len(set(values)) > 1
    )
    return {c: values[0] for c, values in found.items() if len(set(values)) == 1}, tuple(notes)


@dataclass(frozen=True)
class NamePattern:
    """A pattern of the manifest, ready to match stems.

    Attributes:
        text: As the manifest writes it.
        expression: The same as a regular expression with one group a condition.
        units: Condition → unit symbol that follows it in the pattern.
    """

    text: str
    expression: re.Pattern[str]
    units: dict[str, str]

    def read(self, stem: str) -> dict[str, float] | None:
        """Conditions that a stem tells, SI; None where it does not fit the pattern."""
        match = self.expression.match(stem)
        if match is None:
            return None
        numbers = match.groupdict()
        return {
            condition: float(number) if condition == "run_order" else
            _value(number, self.units[condition], condition)
            for condition, number in numbers.items()
        }  # fmt: skip


def compile_pattern(text: str) -> NamePattern:
    """Make a pattern such as ``{amplitude}mm{frequency}Hz_{current}A`` ready.

    A unit stands directly behind its field.  ``{}`` stands for any text.  What follows the whole
    pattern after an underscore, a blank or a hyphen is left alone.

    Raises:
        ManifestError: The pattern is malformed; its place is for the caller to add.
    """
    try:
        pieces = list(string.Formatter().parse(text))
    except ValueError as cause:
        raise ManifestError(f"name pattern {text!r} is malformed: {cause}") from cause
    expression, units = "", {}
    for position, (literal, name, _, _) in enumerate(pieces):
        expression += re.escape(literal)
        if name is None:
            continue
        if name == "":
            expression += ".*?"
            continue
        if name in units or (name not in QUANTITIES and name != "run_order"):
            known = ", ".join((*QUANTITIES, "run_order"))
            what = "stands there twice" if name in units else "is not known"
            raise ManifestError(
                f"field {{{name}}} of name pattern {text!r} {what}", advice=f"Fields: {known}"
            )
        units[name] = ""
        if name == "run_order":
            expression += r"(?P<run_order>\d+)"
            continue
        behind = pieces[position + 1][0] if position + 1 < len(pieces) else ""
        units[name] = _unit_at_start(behind, name, text)
        expression += f"(?P<{name}>{NUMBER})"
    if not units:
        raise ManifestError(
            f"name pattern {text!r} has no fields", advice="Write for example {current}A"
        )
    return NamePattern(text, re.compile(expression + r"(?=$|[_\s-])"), units)


def _unit_at_start(behind: str, name: str, text: str) -> str:
    for symbol in symbols(name):
        if behind.startswith(symbol) and not behind[len(symbol) :][:1].isalpha():
            return symbol
    raise ManifestError(
        f"no unit stands behind {{{name}}} in name pattern {text!r}",
        advice=f"Units of {name}: {', '.join(symbols(name))}",
    )
