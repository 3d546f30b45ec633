"""Faults that only show beside other tests: copies, and a force in another unit."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sysid.data.record import Conditions, Record
from tests.data.quality.test_checks import clean, flickering, report_of, unplugged


def test_duplicates_are_named() -> None:
    first = replace(clean(), id="a")
    second = replace(first, id="b", nominal=Conditions(amplitude=0.01, frequency=2.0, current=9.0))
    report = report_of(first, replace(clean(seed=9), id="c"), second)
    assert [[f.kind for f in test.faults] for test in report.tests] == [[], [], ["duplicate"]]
    assert "'a', under other labels" in report.tests[2].faults[0].evidence


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
