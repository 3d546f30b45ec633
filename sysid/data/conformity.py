"""Does a damper lie within its drawing: peak forces of tests against a tolerance."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from sysid.data.descriptors import describe
from sysid.data.loops import Loops
from sysid.data.tolerance import ForceBand, Tolerance

VELOCITY_NEAR: Final = 0.05
"""In parts of the drawing's velocity: how far off a test may be that stands for it."""
CURRENT_NEAR: Final = (0.02, 0.05)
"""A, and parts of the drawing's current: likewise, the larger of both."""
SURE: Final = 2.0
"""Standard errors of the mean cycle that a force must be off its limit for a verdict."""

Verdict = Literal["inside", "outside", "open"]
SIGN: Final[dict[Verdict, str]] = {"inside": "✓", "outside": "✗", "open": "?"}


@dataclass(frozen=True)
class Peaks:
    """What is read off one test.

    Attributes:
        id: Of the test.
        velocity: Peak velocity Aω, m/s.
        current: A; NaN where unknown.
        temperature: °C; NaN where unknown.
        compression: Largest force, N, the gas force taken off.
        rebound: Largest force the other way, N, likewise.
        gas: Gas force, N; NaN where it is not known.
        scatter: Standard error of the mean cycle, N; NaN where it is not known.
    """

    id: str
    velocity: float
    current: float
    temperature: float
    compression: float
    rebound: float
    gas: float
    scatter: float


@dataclass(frozen=True)
class Judged:
    """One test against its line of the drawing.

    Attributes:
        id: Of the test.
        place: Of the band in the tolerance.
        verdict: "open" where a force is nearer to its limit than it is known.
        words: Why, for a table: what is outside or open and by how much.
    """

    id: str
    place: int
    verdict: Verdict
    words: str

    @property
    def text(self) -> str:
        """Sign and words."""
        return f"{SIGN[self.verdict]} {self.words}"


@dataclass(frozen=True)
class Conformity:
    """All tests against the drawing.

    Attributes:
        tests: Those for which the drawing has a line.
        untested: Places of bands without any test.
        sentence: What came out.
    """

    tests: tuple[Judged, ...]
    untested: tuple[int, ...]
    sentence: str

    def of(self, name: str) -> Judged | None:
        """The verdict on a test; None where the drawing has no line for it."""
        return next((j for j in self.tests if j.id == name), None)


def loop_peaks(loops: Loops) -> tuple[Peaks, ...]:
    """Peak forces of steady loops, the gas force (mean of those at both reversals) taken off.

    Args:
        loops: L tests.
    """
    read = describe(loops)
    gas = read.reversal_force
    off = np.where(np.isfinite(gas), gas, 0.0)
    speed = 2.0 * np.pi * loops.frequency * loops.amplitude
    scatter = loops.noise_floor / np.sqrt(loops.cycles)
    columns = (
        speed, loops.current, loops.temperature, read.peak_compression - off,
        read.peak_rebound + off, gas, scatter,
    )  # fmt: skip
    rows = np.stack(columns, axis=1).tolist()
    return tuple(Peaks(name, *row) for name, row in zip(loops.ids, rows, strict=True))


def conformity(tolerance: Tolerance, tests: Sequence[Peaks]) -> Conformity:
    """Judge tests.

    A test stands for the line of the drawing whose velocity is nearest, if within 5 %, and whose
    current is the same within 20 mA or 5 %; nothing is interpolated.

    Args:
        tolerance: The drawing.
        tests: Peak forces.
    """
    judged: list[Judged] = []
    for test in tests:
        place = _line_for(tolerance, test)
        if place is None:
            continue
        found = _judge(tolerance.bands[place], test, tolerance.gas_included)
        if found is not None:
            judged.append(Judged(test.id, place, *found))
    done = {j.place for j in judged}
    untested = tuple(k for k in range(len(tolerance.bands)) if k not in done)
    return Conformity(tuple(judged), untested, _sentence(judged, untested, len(tolerance.bands)))


def _line_for(tolerance: Tolerance, test: Peaks) -> int | None:
    if tolerance.temperature is not None and math.isfinite(test.temperature):
        low, high = tolerance.temperature
        if not low <= test.temperature <= high:
            return None
    near = [
        (abs(test.velocity / band.velocity - 1.0), band.current is None, place)
        for place, band in enumerate(tolerance.bands)
        if abs(test.velocity / band.velocity - 1.0) <= VELOCITY_NEAR and _same_current(band, test)
    ]
    return min(near)[2] if near else None


def _same_current(band: ForceBand, test: Peaks) -> bool:
    if band.current is None:
        return True
    apart = abs(abs(test.current) - abs(band.current))
    return apart <= max(CURRENT_NEAR[0], CURRENT_NEAR[1] * abs(band.current))


def _judge(band: ForceBand, test: Peaks, gas_included: bool) -> tuple[Verdict, str] | None:
    """None where a force is not known."""
    gas = test.gas if gas_included else 0.0
    forces = {"compression": test.compression + gas, "rebound": test.rebound - gas}
    doubt = SURE * test.scatter if math.isfinite(test.scatter) else 0.0
    told: dict[Verdict, list[str]] = {"inside": [], "outside": [], "open": []}
    for side, limits in (("compression", band.compression), ("rebound", band.rebound)):
        if limits is None:
            continue
        if not math.isfinite(forces[side]):
            return None
        verdict, words = _side(forces[side], limits, doubt)
        told[verdict].append(f"{side} {words}")
    for verdict in ("outside", "open"):
        if told[verdict]:
            return verdict, ", ".join((*told["outside"], *told["open"]))
    return "inside", "inside"


def _side(force: float, limits: tuple[float, float], doubt: float) -> tuple[Verdict, str]:
    low, high = limits
    over, under = force - high, low - force
    beyond, edge, which = (over, high, "above") if over >= under else (under, low, "below")
    if beyond > doubt:
        return "outside", f"{beyond:.3g} N {which} {edge:.4g} N"
    if beyond > -doubt:
        return "open", f"too near to {edge:.4g} N to tell"
    return "inside", "inside"


def _sentence(judged: Sequence[Judged], untested: Sequence[int], lines: int) -> str:
    if not judged:
        return (
            f"No test has the velocity and current of any of the drawing's {_count(lines, 'line')}."
        )

    def number(verdict: Verdict) -> int:
        return sum(j.verdict == verdict for j in judged)

    inside, outside, open_ = number("inside"), number("outside"), number("open")
    told = f"{inside} of {_count(len(judged), 'test')} {_verb(inside)} within the drawing's limits"
    if outside:
        told += f", {outside} {_verb(outside)} outside"
    if open_:
        told += f", and {open_} {'is' if open_ == 1 else 'are'} too near to a limit to tell"
    if untested:
        told += f"; {len(untested)} of the drawing's {_count(lines, 'line')} "
        told += "was not tested" if len(untested) == 1 else "were not tested"
    return f"{told}."


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _verb(number: int) -> str:
    return "lies" if number == 1 else "lie"
