"""Oil that is warmed by work: energy balances, and nothing where the history is not known."""

import numpy as np
import pytest

from sysid.effects.law.self_heating import SelfHeating
from sysid.effects.law.surface_temperature import SurfaceTemperature
from sysid.effects.oil_heat import THINNER, mean_power
from sysid.effects.reference_temperature import REFERENCE
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.lumped import TABLE_1, Lumped
from sysid.motion.history import with_history
from sysid.motion.motion import sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build

VALVE = build(Generalized, LOW_SYMMETRIC)
FREQUENCY = 2.0
LOOPS = sine_motion(0.0125, np.full(4, FREQUENCY), np.array([0.2, 0.2, 0.2, 0.0]), points=72)
CYCLE = np.array([0.0, 9.0, 9999.0, 9.0])
KNOWN = with_history(LOOPS, cycle=CYCLE)


def rise(r_h: float, h_a: float) -> np.ndarray:
    """Temperature that explains what the viscous part has lost, [4] K."""
    damper = Damper(VALVE, (build(SelfHeating, {"r_h": r_h, "h_a": h_a}),))
    lost = np.asarray(VALVE.force(KNOWN) - damper.force(KNOWN))
    viscous = np.asarray(VALVE.parts(KNOWN).viscous)
    share = np.sum(lost * viscous, axis=1) / np.sum(viscous**2, axis=1)
    np.testing.assert_allclose(lost, share[:, None] * viscous, atol=1e-8)
    return -np.log1p(-share) / THINNER


def test_without_cooling_the_oil_keeps_the_work():
    work = np.trapezoid(
        np.asarray(VALVE.force(LOOPS) * LOOPS.velocity)[:, [*range(72), 0]],
        dx=1.0 / (72 * FREQUENCY),
        axis=1,
    )
    np.testing.assert_allclose(rise(1e-4, 0.0), 1e-4 * work * (CYCLE + 0.5), rtol=1e-8)


def test_with_cooling_it_ends_where_the_heat_flows_off():
    power = np.asarray(mean_power(LOOPS, VALVE.force(LOOPS)))[:, 0]
    found = rise(1e-3, 0.05)
    assert found[2] == pytest.approx(1e-3 * power[2] / 0.05, rel=1e-8)
    assert 0.0 < found[0] < found[1] < found[2]
    slow = rise(1e-3, 1e-12)[1]
    assert slow == pytest.approx(rise(1e-3, 0.0)[1], rel=1e-8), "no jump where cooling begins"


def test_the_mean_over_cycles_alone_shows_no_heating():
    damper = Damper(VALVE, (build(SelfHeating, {"r_h": 1e-3, "h_a": 5e-3}),))
    np.testing.assert_allclose(damper.force(LOOPS), VALVE.force(LOOPS), rtol=0.0, atol=1e-9)


def test_the_body_is_colder_in_proportion_to_power():
    damper = Damper(VALVE, (build(SurfaceTemperature, {"R_th": 0.2}),))
    parts = VALVE.parts(LOOPS)
    power = np.asarray(mean_power(LOOPS, parts.total))
    expected = np.asarray(parts.yielding) + np.exp(-THINNER * 0.2 * power) * parts.viscous
    np.testing.assert_allclose(damper.force(LOOPS), expected, rtol=1e-12)
    assert power[0, 0] > 2.0 * power[3, 0], "more current, more power"


def test_a_valve_with_laws_of_temperature_is_read_in_the_warmer_oil():
    valve = build(Lumped, TABLE_1)
    motion = sine_motion(0.005, np.full(3, 4.0), np.array([0.0, 0.4, 1.0]), 25.0, points=96)
    damper = Damper(valve, (build(SurfaceTemperature, {"R_th": 0.02}),))
    rise = 0.02 * np.asarray(mean_power(motion, valve.force(motion)))[:, 0]
    warm = sine_motion(0.005, np.full(3, 4.0), np.array([0.0, 0.4, 1.0]), 25.0 + rise, points=96)
    np.testing.assert_allclose(damper.force(motion), valve.force(warm), rtol=1e-9, atol=1e-6)
    assert rise[2] > 3.0 * rise[0] > 0.3


def test_without_a_thermometer_the_oil_is_warmer_than_the_reference():
    valve = build(Lumped, TABLE_1)
    unknown = sine_motion(0.005, 4.0, 1.0, points=96)
    known = sine_motion(0.005, 4.0, 1.0, REFERENCE, points=96)
    damper = Damper(valve, (build(SurfaceTemperature, {"R_th": 0.02}),))
    np.testing.assert_allclose(damper.force(unknown), damper.force(known), rtol=1e-9, atol=1e-6)


def test_power_is_that_of_the_record_where_there_is_no_cycle():
    time = np.concatenate([np.linspace(0.0, 0.5, 400), np.linspace(0.5, 1.0, 40)[1:]])
    swept = time_motion(time, 0.0125 * np.sin(2.0 * np.pi * FREQUENCY * time), current=0.2)
    found = mean_power(swept, 1000.0 * swept.velocity)
    exact = 1000.0 * 0.5 * (2.0 * np.pi * FREQUENCY * 0.0125) ** 2
    assert float(found[..., 0]) == pytest.approx(exact, rel=0.01)
