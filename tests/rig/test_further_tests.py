"""The same damper back in the rig: what was measured stays, what is hidden is the same."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.harmonics import evaluate
from sysid.errors import DataError
from sysid.rig.bench import Bench, Plan, Setting, set_up
from sysid.rig.chance import Stream
from sysid.rig.planters.bench_state import steady_bench
from sysid.rig.planters.registry import find_planter
from sysid.rig.planters.valve import HystereticValve
from sysid.rig.trial_campaign import make_trial, with_tests
from sysid.rig.trial_design import STANDARD
from sysid.rig.trial_misfit import law_factors
from sysid.trials.quantities import true_quantities

FEW = (Setting(25e-3, 1.5, 0.0), Setting(25e-3, 1.5, 0.4), Setting(75e-3, 0.5, 0.2))
QUIET = replace(
    STANDARD, noise=0.0, gain_sd=0.0, offset_sd=0.0, delay_sd=0.0, amplitude_sd=0.0,
    frequency_sd=0.0, displacement_noise=0.0,
)  # fmt: skip


@pytest.fixture(scope="module")
def chamber():
    return make_trial(7, (find_planter("large_gas_chamber"),), settings=FEW)


def test_the_settings_that_are_asked_for_are_run(chamber):
    assert chamber.loops.ids == ("25mm_1.5Hz_0A", "25mm_1.5Hz_0.4A", "75mm_0.5Hz_0.2A")
    assert chamber.visits == (FEW,)


def test_the_campaign_stays_as_it_was_measured(chamber):
    more = with_tests(chamber, (Setting(1.5e-3, 15.0, 0.3),))
    assert more.loops.ids == (*chamber.loops.ids, "1.5mm_15Hz_0.3A_visit1")
    np.testing.assert_array_equal(more.loops.force[:3], chamber.loops.force)
    np.testing.assert_array_equal(more.run_order, [*chamber.run_order, 4])
    assert more.truth.planters == chamber.truth.planters


def test_a_further_test_finds_the_same_chamber_as_a_campaign_that_had_it_at_once(chamber):
    """Its volume goes by the farthest stroke, which a small test by itself does not know."""
    small = Setting(1.5e-3, 15.0, 0.3)
    apart = with_tests(make_trial(7, chamber.truth.planters, None, QUIET, FEW), (small,))
    together = make_trial(7, chamber.truth.planters, None, QUIET, (*FEW, small))
    for one, other in zip(apart.truth.force, together.truth.force, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)
    added = (apart.truth.force - apart.truth.force_without)[-1]
    assert np.abs(added).max() < 2.0, "a few newtons per millimetre"


WIDE = Setting(75e-3, 0.5, 0.2)
NARROW = (Setting(25e-3, 1.5, 0.0), Setting(25e-3, 1.5, 0.4))


def test_a_wider_stroke_later_finds_the_chamber_that_was_built_for_the_first_ones():
    trial = make_trial(7, (find_planter("large_gas_chamber"),), None, QUIET, NARROW)
    more = with_tests(trial, (WIDE,))
    gas = more.truth.force - more.truth.force_without
    first, last = (float(np.ptp(gas[k]) / np.ptp(more.loops.displacement[k])) for k in (0, -1))
    assert last == pytest.approx(first, rel=0.02), "the stiffness of one spring"
    assert true_quantities(more) == true_quantities(trial)


def test_a_chamber_for_the_strokes_of_the_rig_is_a_spring_at_all_of_them():
    design = replace(QUIET, stroke=75e-3)
    trial = make_trial(7, (find_planter("large_gas_chamber"),), None, design, NARROW)
    more = with_tests(trial, (WIDE,))
    gas, x = (z[-1] for z in (more.truth.force - more.truth.force_without, more.loops.displacement))
    stiffness = next(q.value for q in true_quantities(trial))
    np.testing.assert_allclose(gas, stiffness * x, atol=0.05 * np.abs(gas).max())


def test_a_converter_keeps_its_range_when_larger_forces_come():
    trial = make_trial(7, (find_planter("converter_limit"),), None, QUIET, NARROW)
    more = with_tests(trial, (Setting(25e-3, 2.5, 0.4),))
    limit = np.abs(trial.truth.force).max()
    assert np.abs(more.truth.force_without).max() > 1.05 * np.abs(trial.truth.force_without).max()
    assert np.abs(more.truth.force).max() == pytest.approx(limit, rel=1e-3)


def test_nothing_goes_through_a_stop():
    trial = make_trial(7, (find_planter("rubber_stop"),), None, QUIET, NARROW)
    assert len(with_tests(trial, (Setting(27e-3, 1.5, 0.2),)).loops.ids) == 3
    with pytest.raises(DataError, match="75 mm go through the rubber stops, which are made for 25"):
        with_tests(trial, (WIDE,))


def test_every_visit_has_errors_of_its_own(chamber):
    first = with_tests(chamber, FEW)
    second = with_tests(first, FEW)
    assert len(set(second.loops.ids)) == 9
    visits = second.truth.gain.reshape(3, 3)
    assert len(np.unique(visits)) == 9
    np.testing.assert_array_equal(second.truth.gain[:6], first.truth.gain)


def test_a_triangle_goes_at_constant_speed_between_its_corners():
    trial = make_trial(7, (), None, QUIET, (Setting(10e-3, 2.0, 0.2, triangular=True),))
    loops = trial.loops
    phase = 2.0 * np.pi * np.arange(360) / 360
    omega = 2.0 * np.pi * loops.frequency
    for order, channel in enumerate((loops.displacement, loops.velocity, loops.acceleration)):
        own = evaluate(loops.harmonics, phase, derivative=order, omega=omega)
        np.testing.assert_allclose(channel, own, atol=1e-9 * np.abs(channel).max())
    flank = np.abs(np.sin(phase)) < 0.7
    speed = np.abs(loops.velocity[0][flank])
    np.testing.assert_allclose(speed, 4.0 * 10e-3 * 2.0, rtol=0.1)
    assert trial.loops.ids == ("10mm_2Hz_0.2A_triangle",)


def test_a_raw_record_of_a_triangle_is_refused():
    setting = Setting(10e-3, 2.0, 0.2, triangular=True)
    with pytest.raises(DataError, match="triangle waves are not simulated"):
        set_up(Bench(), setting, Plan(1.0, 1, 4, 1), Stream(1))


def test_sines_beside_a_triangle_are_as_without_it():
    a, f, i = (np.array(z) for z in ([0.01, 0.02], [2.0, 1.0], [0.2, 0.4]))
    valve = HystereticValve(
        make_trial(7, settings=FEW).truth.parameters, law_factors(0.0, a, f, i, 0)
    )
    alone = steady_bench(valve, a, f, i)
    beside = steady_bench(valve, a, f, i, triangular=np.array([True, False]))
    np.testing.assert_array_equal(alone.force[1], beside.force[1])
    assert np.abs(alone.force[0] - beside.force[0]).max() > 10.0


def test_loops_are_joined_in_order(chamber):
    loops = chamber.loops
    one, two = loops.select(np.array([0])), loops.select(np.array([1, 2]))
    joined = one.joined(two)
    assert joined.ids == loops.ids
    for name in ("force", "temperature", "harmonics", "cycles"):
        np.testing.assert_array_equal(getattr(joined, name), getattr(loops, name))
    assert len(joined.deviations) == 3


def test_loops_that_cannot_be_joined_are_refused(chamber):
    with pytest.raises(DataError, match="stands in both"):
        chamber.loops.joined(chamber.loops)
    coarse = make_trial(8, (), None, replace(STANDARD, points=72), FEW)
    with pytest.raises(DataError, match="of 360 and of 72 points"):
        chamber.loops.joined(coarse.loops)
