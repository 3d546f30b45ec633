"""The fit finds what made the data, without being given a start."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from sysid.data.record import Conditions, Record
from sysid.errors import FitError
from sysid.identification.conditions import conditions
from sysid.identification.families import family
from sysid.identification.fit import fit_loops
from sysid.identification.multistart import _basins, _nothing_more_to_find, find_minimum
from sysid.identification.problem import loop_problem, record_motion
from sysid.identification.result import Basin, Result
from sysid.models.generalized import ASYMMETRIC, HIGH_SYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.models.simulate import simulate
from sysid.parameters import as_dict, build
from tests.identification.campaigns import (
    ASYMMETRIC_DESIGN,
    FIVE_CURRENTS,
    HIGH_DESIGN,
    LOW_DESIGN,
    virtual_loops,
)


@pytest.mark.parametrize(
    ("table", "design", "currents", "variant"),
    [
        (LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, "symmetric"),
        (HIGH_SYMMETRIC, HIGH_DESIGN, FIVE_CURRENTS, "symmetric"),
        (ASYMMETRIC, ASYMMETRIC_DESIGN, (0.0, 0.1, 0.2, 0.3), "asymmetric"),
    ],
)
def test_perfect_data_give_the_published_tables_back(table, design, currents, variant):
    fit = fit_loops(virtual_loops(table, design, currents), variant=variant)
    assert fit.result is Result.converged
    assert fit.mean_nrmse < 1e-4
    for symbol in ("F_0", "a_1", "k_2", "a_2", "k_4"):
        assert as_dict(fit.valve)[symbol] == pytest.approx(table[symbol], rel=0.05), symbol


@pytest.mark.parametrize("currents", [(0.2,), (0.1, 0.3)])
def test_settings_of_a_supply_that_wanders_a_little_are_as_good_as_exact_ones(currents):
    """By 0.1 mA: nothing about a law over current is read off that."""
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, currents, noise=0.005)
    wander = 1e-4 * np.random.default_rng(4).standard_normal(loops.current.size)
    exact, wandering = (
        fit_loops(z, variant="symmetric")
        for z in (loops, replace(loops, current=loops.current + wander))
    )
    assert exact.mean_nrmse < 0.004
    assert wandering.mean_nrmse == pytest.approx(exact.mean_nrmse, rel=0.05)


def test_noise_is_what_remains():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.02)
    fit = fit_loops(loops, variant="symmetric")
    rms = np.sqrt(np.mean(loops.force**2, axis=1))
    rmse = np.array([t.rmse for t in fit.tests])
    np.testing.assert_allclose(rmse / rms, 0.02 / 2, rtol=0.15)  # mean of four cycles


def test_cost_is_equation_11():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.02)
    fit = fit_loops(loops, variant="symmetric")
    assert fit.cost == pytest.approx(sum(360 * t.rmse**2 for t in fit.tests), rel=1e-9)


def test_weights_decide_which_tests_count():
    """One loud test with a gross error: weighting by peak keeps the quiet ones right."""
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.01)
    loops.force[-1] *= 1.5
    paper = fit_loops(loops, variant="symmetric", weights="paper")
    peak = fit_loops(loops, variant="symmetric", weights="peak")
    noise = fit_loops(loops, variant="symmetric", weights="noise")
    quiet = slice(0, 1)
    assert peak.tests[quiet][0].nrmse < paper.tests[quiet][0].nrmse
    assert peak.cost == pytest.approx(sum(360 * t.nrmse**2 for t in peak.tests), rel=1e-9)
    assert noise.cost == pytest.approx(
        sum(360 * (t.rmse / t.noise_floor) ** 2 for t in noise.tests), rel=1e-9
    )


def test_held_out_tests_do_not_touch_the_fit():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.01)
    held = np.array(["_5Hz_" in name for name in loops.ids])
    fit = fit_loops(loops, variant="symmetric", held_out=held)
    loops.force[held] *= 7.0
    again = fit_loops(loops, variant="symmetric", held_out=held)
    assert as_dict(again.valve) == as_dict(fit.valve)
    assert again.held_out_mean_nrmse > 5 * fit.held_out_mean_nrmse
    assert [t.held_out for t in fit.tests] == held.tolist()


def test_seeds_do_not_change_the_answer():
    loops = virtual_loops(ASYMMETRIC, ASYMMETRIC_DESIGN, (0.0, 0.1, 0.2, 0.3), noise=0.01)
    costs = [fit_loops(loops, seed=seed).cost for seed in range(5)]
    np.testing.assert_allclose(costs, min(costs), rtol=1e-3)


def test_random_motion_is_fitted_on_its_own_grid():
    rng = np.random.default_rng(0)
    truth = build(Generalized, LOW_SYMMETRIC)
    records = []
    for current in (0.0, 0.1, 0.2, 0.3, 0.4):
        sos = butter(4, 4.0, fs=400.0, output="sos")
        x = sosfiltfilt(sos, rng.standard_normal(4000 + int(1000 * current)))
        x *= 0.006 / x.std()
        silent = Record(
            id=f"random_{current}A",
            time=np.arange(x.size) / 400.0,
            displacement=x + 0.02,
            force=np.zeros(x.size),
            nominal=Conditions(current=current, kind="random"),
        )
        force = np.asarray(simulate(truth, record_motion(silent)))
        noisy = force + 5.0 * rng.standard_normal(x.size)
        records.append(Record(silent.id, silent.time, silent.displacement, noisy,
                              nominal=silent.nominal))  # fmt: skip
    none = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, (0.0,)).select(np.zeros(4, dtype=bool))
    fit = fit_loops(none, others=records, variant="symmetric")
    assert fit.result is Result.converged
    for test in fit.tests:
        assert test.rmse == pytest.approx(5.0, rel=0.05)
    both = fit_loops(
        virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.01),
        others=records, variant="symmetric", held_out=np.array([False] * 20 + [True] * 5),
    )  # fmt: skip
    assert both.held_out_mean_nrmse < 0.02


def test_unknown_current_is_named():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS)
    loops.current[3] = np.nan
    with pytest.raises(FitError, match=r"12\.5mm_0\.5Hz_0\.3A: the current is not known"):
        fit_loops(loops)


def test_unknown_model_and_variant_list_what_there_is():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS)
    with pytest.raises(FitError, match="Known models: generalized"):
        fit_loops(loops, model="magic")
    with pytest.raises(FitError, match="asymmetric, symmetric, passive, mean"):
        fit_loops(loops, variant="lopsided")


def test_nothing_left_to_fit_is_said():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS)
    with pytest.raises(FitError, match="no test is left"):
        fit_loops(loops, held_out=np.ones(20, dtype=bool))


def test_a_model_that_is_finite_nowhere_is_named():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS)
    problem = loop_problem(loops, "peak")
    coordinates = family("dahl").coordinates_for((problem,), "full")
    with pytest.raises(FitError, match="no start of the Dahl model gives a finite force"):
        find_minimum(coordinates, (problem,), np.full(coordinates.size, np.nan))


def test_conditions_join_tests_of_one_amplitude_and_frequency():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS)
    assert conditions(loops).tolist() == sorted([0, 1, 2, 3] * 5)


def test_which_tests_are_of_one_condition_does_not_depend_on_their_order():
    """Strokes that a rig misses more and more: 25.0, 24.4, 23.9 and 23.3 mm."""
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS)
    loops = loops.select(np.arange(4))
    strokes = np.array([25.0e-3, 24.4e-3, 23.9e-3, 23.3e-3])
    loops = replace(loops, amplitude=strokes, current=np.full(4, 0.2))
    found = conditions(loops)
    for order in ([3, 2, 1, 0], [1, 3, 0, 2]):
        other = conditions(loops.select(np.array(order)))
        together = found[order][:, None] == found[order]
        np.testing.assert_array_equal(other[:, None] == other, together)
    assert found.max() + 1 == 4, "none of them is one level with all others"


@pytest.mark.parametrize(("second", "levels"), [(10.3e-3, 1), (11.0e-3, 2)])
def test_a_stroke_that_is_a_tenth_larger_is_another_condition(second, levels):
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS).select(np.arange(4))
    loops = replace(loops, amplitude=np.array([10e-3, 10e-3, second, second]))
    assert conditions(loops).max() + 1 == levels


@pytest.mark.parametrize(
    ("droop", "currents", "levels"),
    [
        (0.04, (0.0, 0.1, 0.2, 0.3, 0.4), 2),
        (0.10, (0.0, 0.1, 0.2, 0.3, 0.4), 2),
        (0.10, (0.2, 0.2, 0.2, 0.2, 0.2), 10),  # as asked for: no current that could explain it
        (0.10, (0.4, 0.3, 0.2, 0.1, 0.0), 10),  # larger strokes with more current
    ],
)
def test_a_stroke_that_falls_as_the_damper_gets_stiffer_is_one_condition(droop, currents, levels):
    """An actuator that loses a tenth of its stroke: five currents at 10 mm, five at 25 mm."""
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS).select(np.arange(10))
    share = 1.0 - droop * np.linspace(0.0, 1.0, 5)
    loops = replace(
        loops, amplitude=np.concatenate([10e-3 * share, 25e-3 * share]),
        frequency=np.full(10, 1.5), current=np.tile(currents, 2),
    )  # fmt: skip
    assert conditions(loops).max() + 1 == levels
    if levels == 2:
        assert conditions(loops).tolist() == [0] * 5 + [1] * 5


def test_basins_are_grouped_by_cost():
    costs = np.array([1.0, 1.0004, 1.0009, 1.2, np.inf, np.nan, 1.2001, 0.9])
    converged = np.array([True] * 7 + [False])
    assert [(round(b.cost, 3), b.hits) for b in _basins(costs, converged)] == [(1.0, 3), (1.2, 2)]


@pytest.mark.parametrize(
    ("basins", "starts", "enough"),
    [
        ([8], 8, True),  # one minimum, every start in it
        ([5], 5, False),  # too few starts to know
        ([2], 16, False),  # best seen twice only
        ([13, 3], 16, False),  # two minima in sixteen starts: there may be more
        ([26, 6], 32, True),
        ([3] + [1] * 13, 16, False),  # every start somewhere else
    ],
)
def test_stopping_rule(basins, starts, enough):
    seen = tuple(Basin(1.0 + k, hits) for k, hits in enumerate(basins))
    assert _nothing_more_to_find(seen, starts) is enough
