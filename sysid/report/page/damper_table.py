"""The table that a damper engineer reads first: peak force against velocity, per current."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from sysid.data.conformity import Conformity, Judged, Peaks, conformity
from sysid.data.tolerance import Tolerance
from sysid.identification.straight_lines.levels import amperes, current_levels
from sysid.report.page.one_test import NAN, OneTest, ReadOff
from sysid.report.page.wording import condition_number, number

COLUMNS: Final = (
    ("test", ""), ("amplitude", "mm"), ("frequency", "Hz"), ("peak velocity", "m/s"),
    ("temperature", "°C"), ("peak compression", "N"), ("peak rebound", "N"), ("γ", ""),
    ("gas", "N"), ("friction", "N"), ("knee", "mm/s"), ("energy a cycle", "J"),
    ("stiffness", "kN/m"), ("damping", "kN·s/m"), ("model: compression", "N"),
    ("model: rebound", "N"),
)  # fmt: skip
"""(name, unit)."""


@dataclass(frozen=True)
class Level:
    """Tests at one current, slowest first.

    Attributes:
        current: As people write it; "unknown" where it is.
        places: Of the tests.
        rows: [n] one text a column.
    """

    current: str
    places: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class DamperTable:
    """All loops, per current.

    Attributes:
        columns: Name and unit.
        levels: Lowest current first.
        model: Whose peaks stand in the last columns.
        chart: What the chart is drawn from: per current the peak velocity, m/s, and the peak forces
            measured and simulated, N.
        conformity: Tests against the damper's drawing; None where there is none.
        limits: The drawing as the chart shows it: velocity, m/s, ends, N, and current.
    """

    columns: tuple[tuple[str, str], ...]
    levels: tuple[Level, ...]
    model: str
    chart: tuple[dict[str, Any], ...]
    conformity: Conformity | None = None
    limits: tuple[dict[str, Any], ...] = ()

    def of(self, name: str) -> Judged | None:
        """The verdict on a test; None where there is none."""
        return None if self.conformity is None else self.conformity.of(name)


def damper_table(
    tests: Sequence[OneTest], model: str, tolerance: Tolerance | None = None
) -> DamperTable:
    """Gather the table.

    Args:
        tests: All tests; those that are no loops are passed over.
        model: Name of the last model.
        tolerance: What the damper's drawing allows.
    """
    at = [k for k, t in enumerate(tests) if t.measured is not None]
    current = np.array([tests[k].current for k in at])
    known = np.flatnonzero(np.isfinite(current))
    groups = [
        (amperes(level), [at[known[n]] for n in places])
        for level, places in (current_levels(current[known]) if known.size else [])
    ]
    silent = [at[n] for n in np.flatnonzero(~np.isfinite(current))]
    if silent:
        groups.append(("unknown", silent))
    levels, chart = [], []
    for name, group in groups:
        places = sorted(
            group, key=lambda k: (tests[k].peak_velocity, tests[k].temperature, tests[k].id)
        )
        levels.append(Level(name, tuple(places), tuple(_row(tests[k]) for k in places)))
        chart.append(_chart(name, [tests[k] for k in places]))
    judged = None if tolerance is None else conformity(tolerance, [_peaks(tests[k]) for k in at])
    return DamperTable(
        COLUMNS, tuple(levels), model, tuple(chart), judged,
        () if tolerance is None else tuple(_limits(tolerance)),
    )  # fmt: skip


def facts(
    test: OneTest, models: Sequence[str], judged: Judged | None = None
) -> list[tuple[str, str]]:
    """Numbers of one test, name and text, for the panel that its cell opens.

    Args:
        test: The test.
        models: Names.
        judged: What the drawing says of it.
    """
    told = [("used as", test.role)]
    if judged is not None:
        told.append(("against the drawing", judged.text))
    if test.traces is not None and test.traces.part:
        told.append(("curves", test.traces.part))
    for name, rmse in zip(models, test.rmse, strict=False):
        told.append((f"RMSE of the curve, {name}", f"{number(rmse)} N"))
    told.append(("peak force", f"{number(test.peak)} N"))
    if np.isfinite(test.noise):
        told.append((f"repeatability, from {test.cycles} cycles", f"{number(test.noise)} N"))
    if np.isfinite(test.mean_cycle_noise):
        told.append(("noise of the mean cycle", f"{number(test.mean_cycle_noise)} N"))
    m = test.measured
    if m is not None:
        told += [
            ("peak compression, rebound", f"{number(m.compression)} N, {number(m.rebound)} N"),
            ("γ = rebound / compression", number(m.gamma)),
            ("gas force, taken off both", f"{number(m.gas)} N"),
            ("friction: half height at rest", f"{number(m.friction)} N"),
            ("knee", f"{number(1e3 * m.knee)} mm/s"),
            ("energy a cycle", f"{number(m.energy)} J"),
            ("effective stiffness", f"{number(1e-3 * m.stiffness)} kN/m"),
            ("equivalent damping", f"{number(1e-3 * m.damping)} kN·s/m"),
        ]
    return told


def _row(t: OneTest) -> tuple[str, ...]:
    m, s = t.measured, t.simulated
    assert m is not None
    where = (1e3 * t.amplitude, t.frequency, t.peak_velocity, t.temperature)
    told = (m.compression, m.rebound, m.gamma, m.gas, m.friction, 1e3 * m.knee, m.energy)
    told += (1e-3 * m.stiffness, 1e-3 * m.damping)
    told += (NAN, NAN) if s is None else (s.compression, s.rebound)
    return (t.id, *(condition_number(z) for z in where), *(number(z) for z in told))


def _peaks(t: OneTest) -> Peaks:
    m = t.measured
    assert m is not None
    return Peaks(
        t.id, t.peak_velocity, t.current, t.temperature, m.compression, m.rebound, m.gas,
        t.mean_cycle_noise,
    )  # fmt: skip


def _limits(tolerance: Tolerance) -> Iterator[dict[str, Any]]:
    """Of each band and side, rebound downwards as in the chart."""
    for band in tolerance.bands:
        current = "any current" if band.current is None else f"{amperes(band.current)} A"
        for ends, sign in ((band.compression, 1.0), (band.rebound, -1.0)):
            if ends is not None:
                low, high = sorted(sign * z for z in ends)
                yield {
                    "velocity": _rounded(band.velocity), "low": _rounded(low),
                    "high": _rounded(high), "current": current,
                }  # fmt: skip


def _chart(name: str, tests: Sequence[OneTest]) -> dict[str, Any]:
    def peaks(reads: Sequence[ReadOff | None], which: str) -> list[float | None]:
        return [None if r is None else _rounded(getattr(r, which)) for r in reads]

    measured, simulated = [t.measured for t in tests], [t.simulated for t in tests]
    return {
        "current": name,
        "velocity": [_rounded(t.peak_velocity) for t in tests],
        "compression": peaks(measured, "compression"),
        "rebound": peaks(measured, "rebound"),
        "model_compression": peaks(simulated, "compression"),
        "model_rebound": peaks(simulated, "rebound"),
    }


def _rounded(value: float) -> float | None:
    return float(f"{value:.5g}") if np.isfinite(value) else None
