"""What a test was meant to be: recorded column > tests.csv > file name > manifest constants."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any, Final, get_args

import numpy as np

from sysid.data.figures import condition
from sysid.data.manifest import ConstantsSection
from sysid.data.record import Array, Conditions, Kind, Record
from sysid.errors import DataError
from sysid.units import find_unit

KINDS: Final[tuple[str, ...]] = get_args(Kind)

_AGREES: Final[dict[str, tuple[float, float]]] = {
    "current": (0.02, 0.05), "voltage": (0.1, 0.05), "temperature": (5.0, 0.0),
}  # fmt: skip
"""Recorded channel → absolute (SI, K) and relative tolerance within which it is steady, and
within which it is what a label says."""
ABSOLUTE_ZERO: Final = -273.15
"""°C."""
THOUSANDS: Final = ("current", "voltage")
"""Conditions that are also recorded in thousandths of their unit."""
NEAR_THOUSAND: Final = 1.02
"""Factor about 1000 within which a recorded channel and its label are the same number."""


def constants_told(constants: ConstantsSection) -> dict[str, float]:
    """Conditions that the manifest gives for every test, SI."""
    told: dict[str, float] = {}
    for name in type(constants).model_fields:
        amount = getattr(constants, name)
        if amount is not None:
            told[name] = amount.si("displacement" if name == "amplitude" else name)
    return told


def merge_conditions(
    record: Record,
    told: Sequence[tuple[str, Mapping[str, object]]],
    constants: ConstantsSection,
) -> tuple[Conditions, tuple[str, ...]]:
    """Put the conditions of a test together.

    Args:
        record: The test; its recorded channels come first.
        told: Who says (``"tests.csv"``, …) → condition → value, in order of precedence.
        constants: Of the manifest; they come last.

    Returns:
        The conditions, and a sentence for every contradiction.

    Raises:
        DataError: A temperature below absolute zero.
    """
    notes: list[str] = []
    known = {f.name for f in fields(Conditions)}
    result: dict[str, Any] = {}
    said_by: dict[str, str] = {}
    for who, values in told:
        for name, value in values.items():
            if name not in known or value is None:
                continue
            if name not in result:
                result[name], said_by[name] = value, who
            elif not _same(result[name], value):
                notes.append(
                    f"{record.id}: {said_by[name]} says {name} {condition(name, result[name])}, "
                    f"{who} says {condition(name, value)}; {said_by[name]} is taken"
                )
    for name in _AGREES:
        channel = getattr(record, name)
        if channel is not None:
            _take_recorded(record.id, name, channel, result, said_by, notes)
    for name, value in constants_told(constants).items():
        if name not in result and getattr(record, name, None) is None:
            result[name] = value
            if name == "temperature":
                result["temperature_sd"] = _temperature_sd(constants)
    if result.get("temperature", 0.0) < ABSOLUTE_ZERO:
        raise DataError(
            f"a temperature of {condition('temperature', result['temperature'])} is below absolute "
            "zero",
            where=record.id,
            advice="Correct its number or its unit, where the test is listed, named or recorded",
        )
    return Conditions(**result), tuple(notes)


def _take_recorded(
    identity: str,
    name: str,
    channel: Array,
    result: dict[str, Any],
    said_by: dict[str, str],
    notes: list[str],
) -> None:
    """A steady recorded channel tells its condition; a label that agrees with it stays."""
    absolute, relative = _AGREES[name]
    low, median, high = (float(q) for q in np.quantile(channel, (0.05, 0.5, 0.95)))
    tolerance = max(absolute, relative * abs(median))
    if high - low > 2.0 * tolerance:
        return
    label = result.get(name)
    constant = float(channel.min()) == float(channel.max())
    if label is None or constant:
        result[name] = median
    if label is not None and abs(label - median) > tolerance:
        _need_same_unit(identity, name, label, median, said_by[name])
        result[name] = median
        notes.append(
            f"{identity}: {said_by[name]} says {name} {condition(name, label)}, the recorded "
            f"{name} is {condition(name, median)}; the recorded one is taken"
        )


def _need_same_unit(identity: str, name: str, label: float, recorded: float, said_by: str) -> None:
    """Refuse a current or voltage that is 1000 times its label, or a thousandth of it."""
    if name not in THOUSANDS or label == 0.0 or recorded == 0.0:
        return
    if abs(abs(np.log10(abs(recorded / label))) - 3.0) < np.log10(NEAR_THOUSAND):
        raise DataError(
            f"{said_by} says {name} {condition(name, label)}, the recorded {name} is "
            f"{condition(name, recorded)}, 1000 times apart: one of them is in another unit",
            where=identity,
            advice="Correct the unit in the header, name it in campaign.toml, or correct the label",
        )


def _temperature_sd(constants: ConstantsSection) -> float | None:
    amount = constants.temperature
    if amount is None or amount.sd is None:
        return None
    return amount.sd * find_unit(amount.unit, "temperature").factor


def _same(one: object, other: object) -> bool:
    if isinstance(one, (int, float)) and isinstance(other, (int, float)):
        return bool(np.isclose(one, other, rtol=1e-6, atol=1e-12))
    return one == other
