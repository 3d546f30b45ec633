"""Unit symbols and SI: the only place where a number changes its unit.

Inside the program everything is SI, except temperature, which is in °C (as in model cards: laws
use differences from a reference temperature, and test engineers think in °C).  Only readers and
exporters call this module.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sysid.errors import UnitError


@dataclass(frozen=True)
class Unit:
    """A unit symbol: `si = factor * number + offset`.

    Attributes:
        symbol: As written by users, e.g. ``"mm"``.
        quantity: One of `SI_SYMBOL`'s keys.
        factor: Multiplier to SI.
        offset: Added after the multiplication (temperatures only), in SI.
    """

    symbol: str
    quantity: str
    factor: float
    offset: float = 0.0


SI_SYMBOL: Final[dict[str, str]] = {
    "time": "s",
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "force": "N",
    "current": "A",
    "voltage": "V",
    "temperature": "degC",
    "frequency": "Hz",
    "phase": "rad",
}
"""Quantity → the symbol of the unit used inside the program and in results."""

_INCH, _POUND, _GRAVITY = 0.0254, 4.4482216152605, 9.80665

UNITS: Final[tuple[Unit, ...]] = (
    Unit("s", "time", 1.0),
    Unit("ms", "time", 1e-3),
    Unit("us", "time", 1e-6),
    Unit("min", "time", 60.0),
    Unit("m", "displacement", 1.0),
    Unit("cm", "displacement", 1e-2),
    Unit("mm", "displacement", 1e-3),
    Unit("um", "displacement", 1e-6),
    Unit("in", "displacement", _INCH),
    Unit("m/s", "velocity", 1.0),
    Unit("cm/s", "velocity", 1e-2),
    Unit("mm/s", "velocity", 1e-3),
    Unit("in/s", "velocity", _INCH),
    Unit("m/s2", "acceleration", 1.0),
    Unit("mm/s2", "acceleration", 1e-3),
    Unit("g", "acceleration", _GRAVITY),
    Unit("N", "force", 1.0),
    Unit("kN", "force", 1e3),
    Unit("lbf", "force", _POUND),
    Unit("kgf", "force", _GRAVITY),
    Unit("A", "current", 1.0),
    Unit("mA", "current", 1e-3),
    Unit("V", "voltage", 1.0),
    Unit("mV", "voltage", 1e-3),
    Unit("degC", "temperature", 1.0),
    Unit("K", "temperature", 1.0, -273.15),
    Unit("degF", "temperature", 5.0 / 9.0, -160.0 / 9.0),
    Unit("Hz", "frequency", 1.0),
    Unit("rad", "phase", 1.0),
    Unit("deg", "phase", np.pi / 180.0),
)

_ALIASES: Final[dict[str, str]] = {
    "sec": "s", "Sec": "s", "msec": "ms", "µs": "us", "μs": "us",
    "µm": "um", "μm": "um", "inch": "in", "inches": "in",
    "mps": "m/s", "mm/sec": "mm/s", "in/sec": "in/s",
    "m/s²": "m/s2", "m/s^2": "m/s2", "mm/s²": "mm/s2", "mm/s^2": "mm/s2",
    "lb": "lbf", "lbs": "lbf", "kp": "kgf",
    "°C": "degC", "C": "degC", "°F": "degF", "F": "degF",
    "°": "deg",
}  # fmt: skip
"""Other spellings of a symbol, exact in case: mm is not Mm, and s is not S."""

_BY_SYMBOL: Final[dict[str, Unit]] = {unit.symbol: unit for unit in UNITS}


def find_unit(symbol: str, quantity: str, *, where: str | None = None) -> Unit:
    """Look a symbol up as a unit of a quantity.

    Args:
        symbol: As the user wrote it; surrounding blanks are ignored.
        quantity: One of `SI_SYMBOL`'s keys.
        where: File and place, for the error.

    Raises:
        UnitError: The symbol is not known, or is a unit of another quantity.
    """
    name = symbol.strip()
    unit = _BY_SYMBOL.get(_ALIASES.get(name, name))
    known = ", ".join(u.symbol for u in UNITS if u.quantity == quantity)
    if unit is None:
        raise UnitError(
            f"unit {symbol!r} of {quantity} is not known",
            where=where,
            advice=f"Known units of {quantity}: {known}",
        )
    if unit.quantity != quantity:
        raise UnitError(
            f"{symbol!r} is a unit of {unit.quantity}, not of {quantity}",
            where=where,
            advice=f"Known units of {quantity}: {known}",
        )
    return unit


def to_si(values: NDArray[np.float64] | float, unit: Unit) -> NDArray[np.float64]:
    """Convert numbers of any shape in `unit` to SI (temperatures to °C)."""
    return np.asarray(values, dtype=np.float64) * unit.factor + unit.offset


def from_si(values: NDArray[np.float64] | float, unit: Unit) -> NDArray[np.float64]:
    """Convert SI numbers of any shape (temperatures in °C) to `unit`."""
    return (np.asarray(values, dtype=np.float64) - unit.offset) / unit.factor
