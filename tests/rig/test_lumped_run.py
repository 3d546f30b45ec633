"""The laboratory's lumped damper: against a reference solution, the fitted model, and physics."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from sysid.parameters import build
from sysid.rig.excitation import SineRun
from sysid.rig.lumped_damper import CURRENTS, FluidMemory, LumpedDamper
from sysid.rig.lumped_run import Heat, run_damper

NO_HEATING = Heat(capacity=1e30)
PAPER = ((10e-3, 8.0), (5e-3, 4.0))
DAMPER = LumpedDamper(gas_force=0.0)


def _run(
    amplitude,
    frequency,
    current,
    temperature,
    damper=DAMPER,
    heat=NO_HEATING,
    cycles=1.5,
    points=144,
):
    """A test from rest: time, motion, what the damper did."""
    run = SineRun(amplitude, frequency, 0.0, (), 0.05, 1.0, cycles, 0.5)
    rate = points * frequency
    time = np.arange(int(run.duration * rate) + 1) / rate
    course = run_damper(
        damper, heat, lambda t: run.state(t).velocity, time, current, frequency, temperature
    )
    return time, run, course


def _reference(time, run, element) -> np.ndarray:
    """[n] N by Radau at 1e-8."""
    bend = element.yield_force / (element.pre_yield - element.post_yield)

    fine = np.linspace(0.0, time[-1], 200_001)
    velocity = run.state(fine).velocity

    def rates(t, y):
        u, w = y
        chi = np.sign(w) * element.yield_force + element.post_yield * w
        if abs(w) <= bend:
            chi = element.pre_yield * w
        return [np.interp(t, fine, velocity) - w, (element.stiffness * u - chi) / element.mass]

    solved = solve_ivp(
        rates, (0.0, time[-1]), [0.0, 0.0], "Radau", time, rtol=1e-8, atol=1e-12, max_step=2e-3
    )
    return element.stiffness * solved.y[0]


@pytest.mark.parametrize(
    ("excitation", "current", "temperature"),
    [(PAPER[0], 1.0, 75.0), (PAPER[0], 0.0, 75.0), (PAPER[1], 0.0, 75.0), (PAPER[0], 2.0, 11.0)],
)
def test_a_whole_test_from_rest_is_within_a_thousandth_of_the_reference(
    excitation, current, temperature
):
    time, run, course = _run(*excitation, current, temperature)
    element = DAMPER.element(current, temperature, excitation[1])
    reference = _reference(time, run, element)
    assert np.max(np.abs(course.force - reference)) < 1e-3 * np.max(np.abs(reference))


def test_halving_the_step_quarters_the_error():
    time, run, _ = _run(*PAPER[0], 0.4, 45.0)
    velocity = lambda t: run.state(t).velocity  # noqa: E731
    forces = [
        run_damper(DAMPER, NO_HEATING, velocity, time, 0.4, 8.0, 45.0, step).force
        for step in (80e-6, 40e-6, 20e-6)
    ]
    coarse, fine = (np.sqrt(np.mean((a - b) ** 2)) for a, b in pairwise(forces))
    assert coarse / fine == pytest.approx(4.0, rel=0.25)


def test_steady_cycles_are_those_of_the_fitted_model():
    conditions = [(*e, i, t) for e in PAPER for i in CURRENTS for t in (15.0, 75.0)]
    amplitude, frequency, current, temperature = np.array(conditions).T
    loops = sine_motion(amplitude, frequency, current, temperature, points=720)
    model = np.asarray(simulate(build(Lumped, TABLE_1), loops))
    for k in (0, 5, 10, 11, 13, 18, 23):
        _, run, course = _run(*conditions[k], cycles=3.0, points=720)
        begin = round((run.rest * run.frequency + 2.0) * 720)
        error = np.max(np.abs(course.force[begin : begin + 720] - model[k]))
        assert error < 1e-3 * np.max(np.abs(model[k])), conditions[k]


def test_table_1_at_its_currents_and_carried_on_beyond():
    """Numbers printed in the paper, worked out by hand."""
    cold, warm = DAMPER.element(0.8, 15.0, 8.0), DAMPER.element(0.8, 75.0, 8.0)
    assert warm.post_yield / cold.post_yield - 1.0 == pytest.approx(-0.334, abs=5e-4)
    assert warm.yield_force / cold.yield_force - 1.0 == pytest.approx(-0.225, abs=5e-4)
    assert warm.stiffness / cold.stiffness - 1.0 == pytest.approx(2.40, abs=1e-9)
    between = DAMPER.element(0.5, 45.0, 8.0)
    assert between.yield_force == pytest.approx(0.5 * (681.85 + 1021.85))
    beyond = DAMPER.element(2.0, 15.0, 8.0)
    assert beyond.yield_force == pytest.approx(1570.7 + 5.0 * (1570.7 - 1402.1))
    assert beyond.stiffness == 3.75e6


def test_the_work_done_heats_the_damper():
    heat = Heat(capacity=200.0, loss=0.0, lag=0.5)
    time, run, course = _run(*PAPER[0], 1.0, 15.0, heat=heat, cycles=4.0)
    power = course.force * run.state(time).velocity
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(time))])
    np.testing.assert_allclose(200.0 * (course.oil - 15.0), work, atol=0.01 * work[-1])
    assert work[-1] > 300.0
    late = course.oil[1:] - course.thermometer[1:]
    rate = np.diff(course.thermometer) / np.diff(time)
    np.testing.assert_allclose(rate, late / 0.5, rtol=0.02, atol=1e-6)


def test_a_pause_cools_towards_the_room():
    heat = Heat(capacity=600.0, loss=1.5, ambient=22.0)
    assert heat.rested(75.0, 400.0) == pytest.approx(22.0 + 53.0 / np.e, rel=1e-12)
    assert heat.rested(11.0, 1e4) == pytest.approx(22.0, abs=1e-6)


def test_the_gas_force_goes_with_absolute_temperature_and_resists_compression():
    cold, warm = (LumpedDamper().element(0.0, t, 8.0).gas_force for t in (15.0, 75.0))
    assert cold == 60.0
    assert warm / cold == pytest.approx(348.15 / 288.15)
    _, _, course = _run(*PAPER[1], 0.4, 15.0, damper=LumpedDamper())
    assert course.force[0] == 60.0


def test_a_fluid_with_memory_is_stiffer_by_the_same_share_each_decade():
    memory = FluidMemory(viscosity=0.05, yield_force=0.08, frequency=2.0)
    damper = LumpedDamper(memory=memory)
    plain = LumpedDamper()
    for frequency, decades in ((2.0, 0.0), (20.0, 1.0), (0.2, -1.0), (8.0, np.log10(4.0))):
        own = damper.element(0.6, 45.0, frequency)
        without = plain.element(0.6, 45.0, frequency)
        assert own.post_yield / without.post_yield == pytest.approx(1 + 0.05 * decades, rel=1e-14)
        assert own.yield_force / without.yield_force == pytest.approx(1 + 0.08 * decades, rel=1e-14)
        assert (own.stiffness, own.gas_force) == (without.stiffness, without.gas_force)


def test_same_speed_at_another_frequency_gives_the_same_plateau_without_memory():
    """20 mm 4 Hz against 10 mm 8 Hz: the post-yield force at mid-stroke depends on speed alone."""

    def plateau(amplitude, frequency, damper):
        time, run, course = _run(amplitude, frequency, 1.0, 45.0, damper=damper)
        turns = (time - run.rest) * frequency
        return course.force[np.argmin(np.abs(turns - 2.0))]

    def change(damper):
        return plateau(20e-3, 4.0, damper) / plateau(10e-3, 8.0, damper) - 1.0

    assert abs(change(DAMPER)) < 0.004
    memory = FluidMemory(viscosity=0.05, yield_force=0.05, frequency=1.0)
    remembering = LumpedDamper(gas_force=0.0, memory=memory)
    expected = (1.0 + 0.05 * np.log10(4.0)) / (1.0 + 0.05 * np.log10(8.0)) - 1.0
    assert change(remembering) - change(DAMPER) == pytest.approx(expected, abs=1e-3)
