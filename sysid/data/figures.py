"""Numbers as engineers write them: without an exponent of ten, currents to what a valve feels."""

import math
from collections.abc import Sequence
from typing import Final

CURRENT_STEP: Final = 1e-4
"""A, to which currents are shown: a supply leaves microamperes, which no valve feels."""
MILLI_BELOW: Final = 0.1
"""A; campaigns whose largest current is smaller are shown in mA."""


def figure(value: float, digits: int = 4) -> str:
    """A number to some significant digits, e.g. ``12350``, ``0.0041``, never ``1.2e+04``.

    Whole digits are never left out, zeros behind the last one always.
    """
    if not math.isfinite(value):
        return "?"
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.{digits - 1}e}")
    decimals = max(digits - 1 - math.floor(math.log10(abs(rounded))), 0)
    text = f"{value:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def current_figures(currents: Sequence[float | None]) -> tuple[str, list[str]]:
    """Currents of one table, all in the unit that suits the largest.

    Args:
        currents: A; None and NaN where unknown.

    Returns:
        ``"A"`` or ``"mA"``, and each current in it: ``"0"`` below half of `CURRENT_STEP`, ``"?"``
        where unknown.
    """
    known = [math.nan if z is None else z for z in currents]
    largest = max((abs(z) for z in known if math.isfinite(z)), default=math.nan)
    milli = 0.5 * CURRENT_STEP <= largest < MILLI_BELOW
    unit, factor = ("mA", 1e3) if milli else ("A", 1.0)
    return unit, [figure(factor * _felt(z)) for z in known]


def ampere(current: float) -> str:
    """A current alone, with its unit, e.g. ``0 A``, ``20 mA``, ``0.25 A``."""
    unit, (shown,) = current_figures((current,))
    return f"{shown} {unit}"


def condition(name: str, value: object) -> str:
    """A condition of a test in the unit that people give it in, e.g. ``12.5 mm``."""
    if not isinstance(value, float):
        return str(value)
    if name == "current":
        return ampere(value)
    factor, unit = _UNITS.get(name, (1.0, ""))
    return f"{figure(factor * value, 6)} {unit}".strip()


_UNITS: Final[dict[str, tuple[float, str]]] = {
    "amplitude": (1e3, "mm"), "frequency": (1.0, "Hz"), "voltage": (1.0, "V"),
    "temperature": (1.0, "°C"), "temperature_sd": (1.0, "K"),
}  # fmt: skip


def _felt(current: float) -> float:
    """To `CURRENT_STEP`, and never minus zero."""
    if not math.isfinite(current):
        return current
    return round(current / CURRENT_STEP) * CURRENT_STEP + 0.0
