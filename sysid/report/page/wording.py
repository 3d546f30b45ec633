"""How the page writes numbers: few digits, and a dash for what is not known."""

import math
from collections.abc import Sequence
from typing import Final

from sysid.diagnosis.words import percent, plain

UNKNOWN: Final = "–"


def number(value: float | None, digits: int = 3) -> str:
    """A number with some significant digits and a true minus sign."""
    if value is None or not math.isfinite(value):
        return UNKNOWN
    return plain(value, digits).replace("-", "−")


def condition_number(value: float) -> str:
    """A condition as people set it: three digits, without zeros behind."""
    return f"{value:.3g}".replace("-", "−") if math.isfinite(value) else UNKNOWN


def share(value: float | None) -> str:
    """A share as per cent."""
    return UNKNOWN if value is None or not math.isfinite(value) else percent(value)


def condition(
    amplitude: float, frequency: float, current: float, temperature: float = math.nan
) -> str:
    """A test's condition, e.g. ``12.5 mm, 0.5 Hz, 0.2 A, 40 °C``; what is unknown is left out.

    Args:
        amplitude: m.
        frequency: Hz.
        current: A.
        temperature: °C.
    """
    told = [
        (1e3 * amplitude, "mm"), (frequency, "Hz"), (round(current, 3) + 0.0, "A"),
        (temperature, "°C"),
    ]  # fmt: skip
    return ", ".join(f"{value:.3g} {unit}" for value, unit in told if math.isfinite(value))


def count(n: int, one: str, many: str | None = None) -> str:
    """``1 test``, ``2 tests``."""
    return f"{n} {one if n == 1 else many or one + 's'}"


def interval(low: float | None, high: float | None, digits: int = 2) -> str:
    """Both ends of an interval, or a dash."""
    known = [z for z in (low, high) if z is not None and math.isfinite(z)]
    return f"{number(low, digits)} … {number(high, digits)}" if len(known) == 2 else UNKNOWN


def first_of(names: Sequence[str], most: int = 4) -> str:
    """The first names of a row, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(names[:most])}{more}"
