"""``[tolerance]`` of `campaign.toml`: what the damper's drawing allows its peak forces to be.

A drawing gives, for some velocities and currents, peak forces of rebound and compression with
limits.  That is what is written down, with its units said once; inside it is SI.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal

from pydantic import BeforeValidator, Field

from sysid.data.manifest_place import Key
from sysid.data.section import Finite, Section, Text
from sysid.errors import ManifestError
from sysid.units import find_unit, to_si

SIDES: Final = ("compression", "rebound")


@dataclass(frozen=True)
class ForceBand:
    """What one peak velocity and current allow.

    Attributes:
        velocity: Peak velocity, m/s.
        current: A; None for whatever current.
        compression: Lowest and highest peak force, N (infinite where there is no such end); None
            where the drawing says nothing.
        rebound: Likewise, N, a positive number.
    """

    velocity: float
    current: float | None
    compression: tuple[float, float] | None
    rebound: tuple[float, float] | None


@dataclass(frozen=True)
class Tolerance:
    """A drawing's bands, in SI.

    Attributes:
        bands: By their order in the manifest.
        gas_included: Whether the drawing's forces hold the gas force.
        temperature: °C, lowest and highest at which the drawing holds; None for any.
    """

    bands: tuple[ForceBand, ...]
    gas_included: bool = False
    temperature: tuple[float, float] | None = None


def _two_numbers(value: Any) -> Any:
    """``[from, to]`` as a table, so that both ways to write limits are one."""
    if not isinstance(value, list):
        return value
    if len(value) != 2:
        raise ValueError("must be two numbers, [lowest, highest]")
    return {"lowest": value[0], "highest": value[1]}


class Limits(Section):
    """Limits of a force: ``[lowest, highest]``, or a nominal value with what it may be off by.

    Attributes:
        lowest: In the table's unit of force, as below; none for no such end.
        highest: Likewise.
        nominal: In the middle.
        percent: Of `nominal`, to either side.
        plus_minus: To either side, in the unit of force; with `percent`, the larger of both counts.
    """

    lowest: Finite | None = None
    highest: Finite | None = None
    nominal: Finite | None = None
    percent: Annotated[float, Field(ge=0, le=100)] | None = None
    plus_minus: Annotated[float, Field(ge=0, allow_inf_nan=False)] | None = None

    def ends(self) -> tuple[float, float]:
        """Lowest and highest force, in the table's unit; infinite where there is no such end."""
        if self.nominal is None:
            return (
                -math.inf if self.lowest is None else self.lowest,
                math.inf if self.highest is None else self.highest,
            )
        off = max(0.01 * (self.percent or 0.0) * abs(self.nominal), self.plus_minus or 0.0)
        return self.nominal - off, self.nominal + off

    def fault(self) -> str | None:
        """What is wrong with them, in words; None if nothing."""
        if self.nominal is not None:
            if self.lowest is not None or self.highest is not None:
                return "has a nominal force and ends; give one of them"
            if self.percent is None and self.plus_minus is None:
                return "has a nominal force without `percent` or `plus_minus`"
            return None
        if self.percent is not None or self.plus_minus is not None:
            return "has `percent` or `plus_minus` without a nominal force"
        if self.lowest is None and self.highest is None:
            return "has no force"
        low, high = self.ends()
        return None if low < high else f"ends at {high:g}, which is not above {low:g}"


ForceLimits = Annotated[Limits | None, BeforeValidator(_two_numbers)]


class Units(Section):
    """``[tolerance] units``: of all numbers in that table.

    Attributes:
        velocity: Symbol.
        current: Symbol.
        force: Symbol.
        temperature: Symbol.
    """

    velocity: Text = "m/s"
    current: Text = "A"
    force: Text = "N"
    temperature: Text = "degC"


class Point(Section):
    """One line of a drawing's table; numbers in the units that stand above it.

    Attributes:
        velocity: Peak velocity.
        current: None for whatever current.
        compression: Peak force.
        rebound: Peak force, a positive number.
    """

    velocity: Finite
    current: Finite | None = None
    compression: ForceLimits = None
    rebound: ForceLimits = None


class ToleranceSection(Section):
    """``[tolerance]``: limits of the peak forces.

    Attributes:
        units: Of all numbers here.
        gas_force: Whether the drawing's forces are those without the gas force or with it.
        temperature: Lowest and highest at which the drawing holds; None for any.
        points: One for each velocity and current.
    """

    units: Units = Units()
    gas_force: Literal["taken off", "included"] = "taken off"
    temperature: Annotated[tuple[Finite, Finite], Field(strict=False)] | None = None
    points: Annotated[tuple[Point, ...], Field(strict=False)] = ()

    def si(self) -> Tolerance | None:
        """The drawing in SI; None where it has no point.

        Raises:
            UnitError: A unit is not known, or is one of another quantity.
        """
        if not self.points:
            return None
        return Tolerance(
            tuple(self._band(point) for point in self.points),
            self.gas_force == "included",
            None
            if self.temperature is None
            else (self._si(self.temperature[0], "temperature"),
                  self._si(self.temperature[1], "temperature")),
        )  # fmt: skip

    def _band(self, point: Point) -> ForceBand:
        def force(limits: Limits | None) -> tuple[float, float] | None:
            if limits is None:
                return None
            low, high = limits.ends()
            return self._si(low, "force"), self._si(high, "force")

        return ForceBand(
            self._si(point.velocity, "velocity"),
            None if point.current is None else self._si(point.current, "current"),
            force(point.compression),
            force(point.rebound),
        )

    def _si(self, value: float, quantity: str) -> float:
        return float(to_si(value, find_unit(getattr(self.units, quantity), quantity)))


def check_tolerance(section: ToleranceSection, place: Callable[[Key], str]) -> None:
    """Refuse units, velocities and limits that cannot be meant.

    Args:
        section: As read.
        place: From a key inside the manifest to where it stands.

    Raises:
        ManifestError: A number contradicts another, or there is none.
        UnitError: A unit is not known, or is one of another quantity.
    """
    for quantity in Units.model_fields:
        symbol = getattr(section.units, quantity)
        find_unit(symbol, quantity, where=place(("tolerance", "units", quantity)))
    ends = section.temperature
    if ends is not None and not ends[0] < ends[1]:
        raise ManifestError(
            "tolerance.temperature ends where it begins, or before",
            where=place(("tolerance", "temperature")),
            advice="Write [lowest, highest]",
        )
    seen: dict[tuple[float, float | None], int] = {}
    for number, point in enumerate(section.points):
        key = ("tolerance", "points", number)
        if point.velocity <= 0:
            raise ManifestError(
                "a peak velocity must be positive",
                where=place((*key, "velocity")),
                advice="Compression and rebound stand beside each other on one line",
            )
        if point.compression is None and point.rebound is None:
            raise ManifestError(
                "a point without compression and rebound allows everything",
                where=place(key),
                advice="Give one of them, such as compression = [250, 310]",
            )
        for side in SIDES:
            limits: Limits | None = getattr(point, side)
            fault = None if limits is None else limits.fault()
            if fault is not None:
                raise ManifestError(
                    f"{side} {fault}",
                    where=place((*key, side)),
                    advice="Write [lowest, highest], or { nominal = 280, percent = 10 }",
                )
            if limits is not None and limits.ends()[1] <= 0:
                raise ManifestError(
                    f"no {side} force can be in these limits, which end at or below zero",
                    where=place((*key, side)),
                    advice="Give magnitudes: forces of rebound are positive here, too",
                )
        same = seen.setdefault((point.velocity, point.current), number)
        if same != number:
            raise ManifestError(
                f"points {same + 1} and {number + 1} have the same velocity and current",
                where=place(key),
                advice="Leave one of them",
            )
