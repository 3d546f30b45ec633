"""Records that are no loops: what of them the page shows."""

import numpy as np
import pytest

from sysid.data.record import Conditions, Record
from sysid.identification.problem import record_motion
from sysid.report.page.damper_table import facts
from sysid.report.page.one_test import HISTORY_POINTS, HISTORY_RATE, OneTest, history_test


def shown(seconds: float, rate: float, odd: float | None = None) -> OneTest:
    """A 15 Hz motion; the model errs most at one time."""
    t = np.arange(0.0, seconds, 1.0 / rate)
    x = 0.01 * np.sin(2.0 * np.pi * 15.0 * t)
    record = Record("long", t, x, 900.0 * x, current=0.0 * t, nominal=Conditions(kind="random"))
    error = np.zeros(t.size) if odd is None else 50.0 * np.exp(-(((t - odd) / 0.01) ** 2))
    return history_test(record, record_motion(record), (record.force + error,), (0.1,), "compared")


@pytest.mark.parametrize(("seconds", "rate"), [(20.0, 1000.0), (3.0, 10_000.0), (12.0, 150.0)])
def test_peaks_are_kept(seconds, rate):
    traces = shown(seconds, rate).traces
    assert traces is not None
    assert traces.part == ""
    assert traces.along[-1] == pytest.approx(seconds, rel=0.01)
    assert 1.0 / np.diff(traces.along).max() > min(rate, HISTORY_RATE) * 0.99
    crossings = np.count_nonzero(np.diff(np.sign(traces.displacement)) != 0)
    assert crossings == pytest.approx(2 * 15 * seconds, abs=2)


def test_of_a_long_record_the_page_shows_where_the_model_errs_and_says_so():
    test = shown(100.0, 1000.0, odd=70.0)
    traces = test.traces
    assert traces is not None
    assert traces.along.size == HISTORY_POINTS
    assert traces.along[0] < 70.0 < traces.along[-1]
    told = dict(facts(test, ["a model"]))
    assert told["curves"] == traces.part
    assert "about the largest error" in traces.part
    last = shown(100.0, 1000.0, odd=99.99).traces
    assert last is not None
    assert last.along[-1] == pytest.approx(100.0, abs=0.01)
