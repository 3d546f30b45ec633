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
        verdict: "open" where a force is nearer to its limit than it is known, and where the drawing
            holds at some temperatures and that of the test is not known.
        words: Why, for a table: what is outside or open and by how much.
        warmth_unknown: It is open for its temperature.
    """

    id: str
    place: int
    verdict: Verdict
    words: str
    warmth_unknown: bool = False

    @property
    def text(self) -> str:
        """Sign and words."""
        return f"{SIGN[self.verdict]} {self.words}"


@dataclass(frozen=True)
class NotJudged:
    """A test that has a line of the drawing, at a temperature at which that does not hold.

    Attributes:
        id: Of the test.
        place: Of the band in the tolerance.
        temperature: Of the test, °C.
    """

    id: str
    place: int
    temperature: float


@dataclass(frozen=True)
class Conformity:
    """All tests against the drawing.

    Attributes:
        tests: Those for which the drawing has a line.
        untested: Places of bands without any test.
        sentence: What came out.
        not_judged: Tests that have a line, too, and are colder or warmer than the drawing's.
    """

    tests: tuple[Judged, ...]
    untested: tuple[int, ...]
    sentence: str
    not_judged: tuple[NotJudged, ...] = ()

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
    columns = (
        speed, loops.current, loops.temperature, read.peak_compression - off,
        read.peak_rebound + off, gas, loops.mean_cycle_noise,
    )  # fmt: skip
    rows = np.stack(columns, axis=1).tolist()
    return tuple(Peaks(name, *row) for name, row in zip(loops.ids, rows, strict=True))


def conformity(tolerance: Tolerance, tests: Sequence[Peaks]) -> Conformity:
    """Judge tests.

    A test stands for the line of the drawing whose velocity is nearest, if within 5 %, and whose
    current is the same within 20 mA or 5 %; nothing is interpolated.  Where the drawing holds at
    some temperatures, a test outside of these is not judged, and one of an unknown temperature is
    open.

    Args:
        tolerance: The drawing.
        tests: Peak forces.
    """
    judged: list[Judged] = []
    aside: list[NotJudged] = []
    for test in tests:
        place = _line_for(tolerance, test)
        if place is None:
            continue
        found = _judge(tolerance.bands[place], test, tolerance.gas_included)
        if found is None:
            continue
        if tolerance.temperature is None or _within(tolerance.temperature, test.temperature):
            judged.append(Judged(test.id, place, *found))
        elif math.isfinite(test.temperature):
            aside.append(NotJudged(test.id, place, test.temperature))
        else:
            words = f"temperature not known; if it is {_span(tolerance.temperature)}: "
            judged.append(Judged(test.id, place, "open", f"{words}{found[1]}", warmth_unknown=True))
    done = {j.place for j in judged}
    untested = tuple(k for k in range(len(tolerance.bands)) if k not in done)
    sentence = _sentence(tolerance, judged, aside, untested)
    return Conformity(tuple(judged), untested, sentence, tuple(aside))


def _within(ends: tuple[float, float], temperature: float) -> bool:
    return ends[0] <= temperature <= ends[1]


def _span(ends: tuple[float, float]) -> str:
    return f"{ends[0]:g} to {ends[1]:g} °C"


def _line_for(tolerance: Tolerance, test: Peaks) -> int | None:
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


def _sentence(
    tolerance: Tolerance,
    judged: Sequence[Judged],
    aside: Sequence[NotJudged],
    untested: Sequence[int],
) -> str:
    lines, held = len(tolerance.bands), tolerance.temperature
    span = "" if held is None else _span(held)
    if not judged and not aside:
        return (
            f"No test has the velocity and current of any of the drawing's {_count(lines, 'line')}."
        )
    if not judged:
        return (
            f"No test is judged: {_count(len(aside), 'test')} {_has(len(aside))} the velocity and "
            f"current of a line, at {_warmth(aside)}, and the drawing holds at {span} only."
        )

    def number(verdict: Verdict) -> int:
        return sum(j.verdict == verdict and not j.warmth_unknown for j in judged)

    inside, outside, open_ = number("inside"), number("outside"), number("open")
    unknown = sum(j.warmth_unknown for j in judged)
    told = f"{inside} of {_count(len(judged), 'test')} {_verb(inside)} within the drawing's limits"
    if outside:
        told += f", {outside} {_verb(outside)} outside"
    if open_:
        told += f", and {open_} {_is(open_)} too near to a limit to tell"
    if unknown:
        told += f"; {unknown} {_is(unknown)} open: the drawing holds at {span}, and the temperature"
        told += " is not known"
    if aside:
        told += f"; {_count(len(aside), 'more test')} {_has(len(aside))} a line and "
        told += f"{_is(len(aside))} not judged, at {_warmth(aside)} and not {span}"
    if untested:
        told += f"; {len(untested)} of the drawing's {_count(lines, 'line')} "
        told += "was not tested" if len(untested) == 1 else "were not tested"
        told += f" at {span}" if aside else ""
    return f"{told}."


def _warmth(aside: Sequence[NotJudged]) -> str:
    """Temperatures of tests, as a range where they differ."""
    low, high = (f"{f(t.temperature for t in aside):.3g}" for f in (min, max))
    return f"{low} °C" if low == high else f"{low} to {high} °C"


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _verb(number: int) -> str:
    return "lies" if number == 1 else "lie"


def _is(number: int) -> str:
    return "is" if number == 1 else "are"


def _has(number: int) -> str:
    return "has" if number == 1 else "have"
