"""Whatever a record holds, an inspection ends with a report, not with an exception."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sysid.data.campaign import Campaign
from sysid.data.descriptors import describe
from sysid.data.manifest import Manifest
from sysid.data.quality import inspect
from sysid.data.record import Record

SHAPES = ("zero", "constant", "sine", "noisy sine", "noise", "ramp", "square", "late")


def shape(name: str, n: int, cycles: float, rng: np.random.Generator) -> np.ndarray:
    u = np.arange(n) / n
    wave = np.sin(2 * np.pi * cycles * u)
    return {
        "zero": np.zeros(n),
        "constant": np.ones(n),
        "sine": wave,
        "noisy sine": wave + 0.05 * rng.normal(size=n),
        "noise": rng.normal(size=n),
        "ramp": u,
        "square": np.sign(wave),
        "late": np.where(u > 0.5, wave, 0.0),
    }[name]


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    motion=st.sampled_from(SHAPES),
    load=st.sampled_from(SHAPES),
    n=st.sampled_from([2, 3, 8, 9, 13, 40, 200, 1000]),
    cycles=st.floats(0.2, 30.0),
    size=st.floats(-7.0, 1.0),
    pace=st.floats(-5.0, 1.0),
    even=st.booleans(),
    hole=st.booleans(),
)
def test_any_record_gives_a_report(
    motion: str,
    load: str,
    n: int,
    cycles: float,
    size: float,
    pace: float,
    even: bool,
    hole: bool,
) -> None:
    rng = np.random.default_rng(0)
    step = np.ones(n) if even else rng.uniform(0.1, 1.9, n)
    force = 1e3 * shape(load, n, cycles, rng)
    if hole:
        force[n // 2] = np.nan
    record = Record(
        "odd", np.cumsum(step) * 10.0**pace, 10.0**size * shape(motion, n, cycles, rng), force
    )
    report = inspect(Campaign("odd", Path("."), (record,), Manifest()))
    (test,) = report.tests
    assert (test.left_out is None) == (report.cut.loops.ids == ("odd",))
    assert len(report.to_frame()) == 1
    if test.left_out is None:
        assert test.cycles >= 1
        assert np.all(np.isfinite(report.cut.loops.force))
        assert np.all(np.isfinite(report.cut.loops.acceleration))
        assert describe(report.cut.loops).energy.shape == (1,)
    else:
        assert not report.trustworthy
        assert report.untrusted[-1] == "no test gives a sound loop"


@pytest.mark.parametrize("kind", ["random", "current_step", "triangle"])
def test_declared_kinds_are_inspected_without_loops(kind: str) -> None:
    from dataclasses import replace

    from tests.data.quality.planted import clean, faults_of

    record = clean()
    declared = replace(record, nominal=replace(record.nominal, kind=kind))
    assert faults_of(declared) == {}
    assert set(faults_of(replace(declared, force=-declared.force))) == {"wrong_sign"}
