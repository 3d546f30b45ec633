"""A slice of `benchmarks/lumped_recovery.py`: Table 1 is found again from loops alone."""

from dataclasses import replace

import numpy as np
import pytest
from lumped_recovery import EXACT, NOISE, TABLE_1, sweep, worst_error
from temperature_laws import CURRENTS, POINTS, TEMPERATURES

from sysid.data.loops import Loops
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit, Result
from sysid.identification.statics import statics_of
from sysid.parameters import as_dict
from sysid.uncertainty.covariance import sandwich


def small(noise: float = 0.0, seed: int = 0) -> Loops:
    """56 of the 156 loops; the size of another benchmark, so that it is compiled once for both."""
    return sweep(noise, seed, POINTS, CURRENTS, TEMPERATURES)


@pytest.fixture(scope="module")
def noisy() -> Fit:
    return fit_loops(small(NOISE), model="lumped")


def test_without_noise_the_table_comes_back():
    fit = fit_loops(small(), model="lumped")
    assert fit.result is Result.converged
    assert worst_error(fit)[0] < 1e-3 * EXACT
    assert fit.mean_nrmse < 1e-8


def test_with_noise_only_the_noise_is_left(noisy):
    assert noisy.result is Result.converged
    loops = small(NOISE)
    relative = [t.rmse for t in noisy.tests] / np.sqrt(np.mean(loops.force**2, axis=1))
    assert np.median(relative) == pytest.approx(NOISE, rel=0.05)


def test_intervals_hold_the_truth_and_everything_free_is_determined(noisy):
    estimates = sandwich(noisy)
    assert estimates.symbols == noisy.coordinates.free
    free = [p for p in estimates.parameters if p.symbol in estimates.symbols]
    assert len(free) == 18
    inside = [p.low <= TABLE_1[p.symbol] <= p.high for p in free]
    assert sum(inside) >= 16
    by_symbol = {p.symbol: p for p in estimates.parameters}
    assert by_symbol["C_post[1 A].slope"].high < 0.0 < by_symbol["k.slope"].low
    assert by_symbol["tau"].sd == by_symbol["C_pre"].sd == by_symbol["m_l"].sd == 0.0
    assert noisy.notes == noisy.coordinates.remarks


def test_a_damper_without_current_is_identified_alone():
    """The supply is off, its meter wanders by 10 µA, and inertia outweighs the spring."""
    loops = small(NOISE)
    off = loops.select(loops.current == 0.0)
    wander = 1e-5 * np.random.default_rng(6).standard_normal(len(off.ids))
    fit = fit_loops(replace(off, current=wander), model="lumped")
    assert fit.result is Result.converged
    assert fit.coordinates.currents == (0.0,)
    warm, viscosity = float(off.temperature.max()), "C_post[0 A]"
    found, truth = (
        table[f"{viscosity}.intercept"] + warm * table[f"{viscosity}.slope"]
        for table in (as_dict(fit.valve), TABLE_1)
    )
    assert found == pytest.approx(truth, rel=0.02)


def test_a_static_force_changes_neither_parameters_nor_intervals(noisy):
    """A gas force as on BS09's damper, and 2 N of a load cell from test to test."""
    loops = small(NOISE)
    statics = (
        57.0
        + 0.2 * loops.temperature
        + 2.0 * np.random.default_rng(3).standard_normal(len(loops.ids))
    )
    pushed = replace(loops, force=loops.force + statics[:, None])
    fit = fit_loops(pushed, model="lumped", max_waves=1)
    plain, beside = sandwich(noisy), sandwich(fit)
    for one, other in zip(plain.parameters, beside.parameters, strict=True):
        assert other.value == pytest.approx(one.value, abs=1e-4 * one.sd)
        assert other.sd == pytest.approx(one.sd, rel=1e-3)
    assert fit.mean_nrmse > 5.0 * noisy.mean_nrmse
    force, noise = statics_of(fit, pushed), statics_of(noisy, loops)
    assert force is not None
    assert noise is not None
    np.testing.assert_allclose(force.value - noise.value, statics, atol=1e-3)
    assert force.line is not None
    (low, high), (flat, steep) = force.line.intervals
    assert low < 57.0 < high
    assert flat < 0.2 < steep
    larger = np.abs(pushed.force).max(axis=1) / np.abs(loops.force).max(axis=1)
    same = np.mean([t.nrmse / more for t, more in zip(noisy.tests, larger, strict=True)])
    assert force.mean_nrmse == pytest.approx(same, rel=0.02), "the same error of a larger force"


def test_where_a_current_was_only_warm_its_slopes_are_said_to_be_open():
    """At 0.4 A there is nothing but 75 °C, seven times."""
    loops = small(NOISE)
    tests = np.arange(56).reshape(4, 7, 2)
    tests[CURRENTS.index(0.4)] = tests[CURRENTS.index(0.4), -1]
    estimates = sandwich(fit_loops(loops.select(tests.ravel()), model="lumped", max_waves=1))
    open_ones = {p.symbol for p in estimates.parameters if not p.identified}
    assert {"C_post[0.4 A].slope", "F_y[0.4 A].slope"} <= open_ones
    assert not any(s.startswith("k") or "[1 A]" in s for s in open_ones)
    assert any("0.4 A" in sentence for sentence in estimates.undetermined)
