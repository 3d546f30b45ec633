"""How people spell numbers with units in file names: ``0.2Amp``, ``0.2 A``, ``25mmpp``.

What can mean one thing only is respelled as `names` reads it; what may mean two is told of, and not
taken.
"""

import re
from typing import Final

from sysid.units import UNITS

QUANTITIES: Final[dict[str, str]] = {
    "amplitude": "displacement",
    "frequency": "frequency",
    "current": "current",
    "voltage": "voltage",
    "temperature": "temperature",
}
"""Condition → quantity of its unit."""

NUMBER: Final = r"[+-]?\d+(?:[.,x]\d+)?"
_SPELLINGS: Final[dict[str, tuple[str, ...]]] = {
    "temperature": ("degC", "degF", "°C", "°F", "C", "F", "K"),
}
"""Unit spellings in names, where they are more than the symbols of `sysid.units`."""


def symbols(condition: str) -> tuple[str, ...]:
    """Units of a condition as they stand in names, the longest first."""
    quantity = QUANTITIES[condition]
    plain = tuple(unit.symbol for unit in UNITS if unit.quantity == quantity)
    return tuple(sorted(_SPELLINGS.get(condition, plain), key=len, reverse=True))


def _any(spellings: "tuple[str, ...] | list[str]") -> str:
    return "|".join(re.escape(z) for z in sorted(spellings, key=len, reverse=True))


SYMBOLS: Final = _any([symbol for condition in QUANTITIES for symbol in symbols(condition)])
"""All of them, as part of a regular expression."""

_WORDS: Final[dict[str, str]] = {
    **dict.fromkeys(("Amp", "Amps", "Ampere", "Amperes", "amp", "amps", "ampere", "amperes"), "A"),
    **dict.fromkeys(("Volt", "Volts", "volt", "volts"), "V"),
    **dict.fromkeys(("HZ", "hz"), "Hz"),
    **dict.fromkeys(("MM",), "mm"),
    **dict.fromkeys(("inch", "inches"), "in"),
}
"""Words that mean one unit → its symbol."""
_WORD: Final = re.compile(rf"({NUMBER})([\s_]?)({_any(list(_WORDS))})(?![A-Za-z°])")
_PEAK: Final = re.compile(
    rf"{NUMBER}\s?(?:{_any(symbols('amplitude'))}|MM)[\s_-]*\(?"
    r"(?:pk?[\s_-]*(?:2|to?)?[\s_-]*pk?|peak[\s_-]*(?:2|to)?[\s_-]*peak)\)?(?![A-Za-z0-9])",
    re.IGNORECASE,
)
_APART: Final = re.compile(rf"(?<![A-Za-z0-9.,°])({NUMBER})([\s_])({SYMBOLS})(?![A-Za-z0-9°])")
_SPLIT: Final = re.compile(rf"(?:(?<=[_\s])|^)(\d{{1,3}})_(\d+)(_?)({SYMBOLS})(?![A-Za-z°])")
"""A whole number before a whole number with a unit: ``0_5A``, ``01_10mm``."""
_SPLIT_BEFORE: Final = re.compile(r"(?:[_\s]|^)\d{1,3}_$")
_DECIMAL: Final = re.compile(rf"\d[.,x]\d+\s?(?:{SYMBOLS})(?![A-Za-z°])")
_SHORT: Final = 2
"""Letters of a unit from which on it is no word or numbering of its own; ``in`` is one."""
_UNIT_BEFORE: Final = re.compile(rf"\d\s?(?:{SYMBOLS})[\s_,-]*$")
_NUMBERING: Final = re.compile(
    r"(?:^|[\s_,-])(?:v|ver|version|rev|revision|no|nr|run|test|sample|part|oil|fluid)[.\s]*$",
    re.IGNORECASE,
)
"""Words in front of a number that count something."""
_NEAR: Final = re.compile(
    rf"{NUMBER}-?(?:"
    r"(?:(?:mm|cm|um|µm|hz)[a-rt-z]?|ma{1,2}|mv{1,2}|deg[cf]|m(?:amp|volt)[a-z]*)"
    r"|(?P<short>aa?|vv?|cc?|kk?|ff?|mm?|amp[a-z]*|volt[a-z]*)"
    r")(?:pk|peak|rms|max|min)?",
    re.IGNORECASE,
)
"""A unit in the wrong case, with a letter too many (not ``s``: ``mms`` is a speed), or more."""


def decimal_or_index(text: str, notes: list[str]) -> str:
    """A name without the values that an underscore may have as their decimal point: ``0_5A``.

    It is none behind a number that counts: ``run_2_1A``, ``01_10mm``, and ``1_10mm_0.5A``, whose
    decimal point is another.

    Args:
        text: Name, respelled.
        notes: Gets a sentence on each value that is not taken.
    """

    def told(found: re.Match[str]) -> str:
        whole, digits, _, unit = found.groups()
        before = text[: found.start()].rstrip("_")
        counts = _NUMBERING.search(before) or (not before and _DECIMAL.search(text))
        if whole != "0" and (counts or whole[0] == "0"):
            return found[0]
        notes.append(
            f"{found[0]!r} in the name may be {whole}.{digits}{unit}, or {digits}{unit} behind a "
            f"number of its own; not taken. Write {whole}.{digits}{unit} if it is that, or tell it "
            "in tests.csv"
        )
        return ""

    return _SPLIT.sub(told, text)


def respelled(stem: str) -> tuple[str, list[str]]:
    """A name with units in the spelling that is read, and what is not taken of it.

    Args:
        stem: File name without its ending.

    Returns:
        The name, and sentences on what is not taken, without it.
    """
    notes: list[str] = []

    def two_sided(found: re.Match[str]) -> str:
        notes.append(
            f"{found[0]!r} in the name may be the whole stroke or half of it; not taken. "
            "Tell the amplitude, half the stroke, in tests.csv (amplitude_mm)"
        )
        return "_"

    text = _PEAK.sub(two_sided, stem)
    text = _WORD.sub(lambda found: found[1] + found[2] + _WORDS[found[3]], text)
    while True:  # each one that is joined may tell what the next is
        joined = _APART.sub(_joined, text)
        if joined == text:
            break
        text = joined
    notes.extend(
        f"{found[0]!r} in the name may be a number with a unit or not; not taken. Write "
        f"{found[1] + found[3]} if it is"
        for found in _APART.finditer(text)
        if not (_is_numbering(found) or _SPLIT_BEFORE.search(text[: found.start()]))
    )
    return text, notes


def _joined(found: re.Match[str]) -> str:
    """Number and unit without the blank between them, if they can be nothing else."""
    before, behind = found.string[: found.start()], found.string[found.end() :]
    if found[2] == "_" or _NUMBERING.search(before):
        return found[0]
    if not _is_short(found[3]) or not _is_whole(found[1]):
        return found[1] + found[3]
    first = not before and re.match(rf"[\s,-]+{NUMBER}\s?(?:{SYMBOLS})(?![A-Za-z°])", behind)
    return found[1] + found[3] if first or _UNIT_BEFORE.search(before) else found[0]


def _is_numbering(found: re.Match[str]) -> bool:
    """Whether a whole number and a letter behind an underscore belong to no condition: ``run_2_A``.

    Behind another condition they may.
    """
    plain = found[2] == "_" and _is_short(found[3]) and _is_whole(found[1])
    return plain and not re.search(rf"\d[\s_]?(?:{SYMBOLS})_$", found.string[: found.start()])


def _is_short(symbol: str) -> bool:
    return len(symbol) < _SHORT or symbol == "in"


def _is_whole(number: str) -> bool:
    return number.lstrip("+-").isdigit()


def is_near(token: str, *, others: bool) -> bool:
    """Whether a piece of a name is nearly a number with a unit: ``2Hzz``, ``250ma``, ``0.2a``.

    Args:
        token: A piece without blanks that is not read.
        others: Other pieces of the name are read; else a whole number and a letter, ``4a``, is a
            numbering.
    """
    found = _NEAR.fullmatch(token)
    if found is None:
        return False
    if found["short"] is None or re.match(r"[+-]?\d+[.,x]\d", token):
        return True
    return others and len(found["short"]) == 1 and token.endswith(found["short"])
