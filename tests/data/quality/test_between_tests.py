"""Faults that only show beside other tests: copies, and a force in another unit."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sysid.data.record import Conditions, Record
from tests.data.quality.planted import clean, flickering, report_of, unplugged


def test_duplicates_are_named() -> None:
    first = replace(clean(), id="a")
    second = replace(first, id="b", nominal=Conditions(amplitude=0.01, frequency=2.0, current=9.0))
    report = report_of(first, replace(clean(seed=9), id="c"), second)
    assert [[f.kind for f in test.faults] for test in report.tests] == [[], [], ["duplicate"]]
    assert "'a', under other labels" in report.tests[2].faults[0].evidence


@pytest.mark.parametrize(
    ("off", "severity"), [(-0.01, None), (-0.03, "warning"), (-0.06, "fatal"), (-1.0, "fatal")]
)
def test_a_current_below_zero_is_held_against_the_largest(off: float, severity: str | None) -> None:
    records = [replace(clean(seed=k, current=i), id=f"{i}") for k, i in enumerate((off, 0.5, 1.0))]
    found = [f for t in report_of(*records).tests for f in t.faults if f.kind == "negative_current"]
    assert [f.severity for f in found] == ([] if severity is None else [severity])


def of_a_matrix(frequency: float, current: float, factor: float = 1.0, name: str = "") -> Record:
    """A test at some frequency (Hz) and current (A), its force times a factor."""
    record = clean(frequency=frequency, current=current, noise=1.0)
    name = name or f"{frequency:g}Hz_{current:g}A"
    return replace(record, id=name, force=factor * (1.0 + 10.0 * current) * record.force)


@pytest.mark.parametrize(("factor", "words"), [(1e-3, "1/1000 of"), (1e3, "1000 times")])
def test_one_file_in_another_unit_is_named(factor: float, words: str) -> None:
    sound = [of_a_matrix(f, i) for f in (0.5, 2.0, 4.0) for i in (0.0, 1.0)]
    report = report_of(*sound, of_a_matrix(1.0, 1.0, factor, "odd"))
    found = {t.id: [f for f in t.faults if f.kind == "force_scale"] for t in report.tests}
    assert [name for name, faults in found.items() if faults] == ["odd"]
    assert found["odd"][0].severity == "fatal"
    assert words in found["odd"][0].evidence
    assert "3 other tests" in found["odd"][0].evidence


@pytest.mark.parametrize("odd", range(4))
@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_one_file_in_another_unit_is_named_where_every_current_has_one_test(
    odd: int, factor: float
) -> None:
    currents = (0.0, 0.2, 0.5, 0.8)
    records = [of_a_matrix(1.0 + i, i, factor if k == odd else 1.0, f"{k}")
               for k, i in enumerate(currents)]  # fmt: skip
    report = report_of(*records)
    found = {t.id: f for t in report.tests for f in t.faults if f.kind == "force_scale"}
    assert list(found) == [f"{odd}"]
    assert "3 other tests (median)" in found[f"{odd}"].evidence
    assert "speed, current and temperature" in found[f"{odd}"].evidence


@pytest.mark.parametrize("times", [1.0, 12.0, 100.0])
def test_a_damper_may_have_any_range_of_forces_between_its_currents(times: float) -> None:
    """A hundred times the force at current, each at another speed; more than any damper has."""
    records = [of_a_matrix(f, i) for f, i in ((0.5, 0.0), (4.0, 0.5), (1.0, 1.0), (2.0, 2.0))]
    records = [
        replace(r, force=r.force / (1.0 + 10.0 * (r.nominal.current or 0.0)) * size)
        for r, size in zip(records, (1.0, times, times, times), strict=True)
    ]
    assert not any(f.kind == "force_scale" for t in report_of(*records).tests for f in t.faults)


def test_of_two_tests_none_is_called_the_odd_one() -> None:
    report = report_of(of_a_matrix(1.0, 0.0, 1e-3), of_a_matrix(1.0, 1.0))
    assert not any(f.kind == "force_scale" for t in report.tests for f in t.faults)


@pytest.mark.parametrize("change", [unplugged(4.0), flickering])
def test_a_silent_channel_is_not_called_another_unit(change: Callable[[Record], Record]) -> None:
    sound = [of_a_matrix(f, 1.0) for f in (0.5, 2.0, 4.0)]
    report = report_of(*sound, replace(change(of_a_matrix(1.0, 1.0)), id="dead"))
    assert {t.id for t in report.tests if t.fatal} == {"dead"}
    assert not any(f.kind == "force_scale" for t in report.tests for f in t.faults)


def test_tests_of_unknown_current_are_not_compared() -> None:
    records = [of_a_matrix(f, 1.0, factor) for f, factor in ((1.0, 1e-3), (2.0, 1.0), (4.0, 1.0))]
    unknown = [replace(r, nominal=replace(r.nominal, current=None)) for r in records]
    assert any(f.kind == "force_scale" for t in report_of(*records).tests for f in t.faults)
    assert not any(f.kind == "force_scale" for t in report_of(*unknown).tests for f in t.faults)


def test_a_viscous_damper_over_three_decades_of_speed_has_one_scale() -> None:
    records = []
    for frequency in (0.01, 0.1, 1.0, 10.0):
        record = clean(frequency=frequency, rate=200.0 * frequency, noise=0.0, rest=0.0, ramp=0.0)
        speed = np.gradient(record.displacement, record.time)
        records.append(replace(record, id=f"{frequency:g}", force=2e3 * speed))
    assert not any(f.kind == "force_scale" for t in report_of(*records).tests for f in t.faults)
