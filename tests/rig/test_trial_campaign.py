"""Trial campaigns: what a diagnosis is given, and the truth kept beside it."""

import time
from dataclasses import fields, replace

import numpy as np
import pytest

from sysid.data.harmonics import evaluate
from sysid.errors import DataError
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.motion import loop_motion
from sysid.parameters import build
from sysid.rig.planters.planter import Planter
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.rig.trial_design import STANDARD
from sysid.rig.trial_matrix import settings_below
from sysid.rig.trial_misfit import law_factors

SEED = 20260


@pytest.fixture(scope="module")
def clean() -> Trial:
    return make_trial(SEED)


def test_matrix_is_w11_s_below_its_speed():
    settings = settings_below(0.4)
    assert len(settings) == 110
    assert len({(s.amplitude, s.frequency) for s in settings}) == 22
    assert len(settings_below(1e9)) == 165
    assert max(2.0 * np.pi * s.amplitude * s.frequency for s in settings) <= 0.4


def test_tests_are_drawn_and_conditions_recorded(clean: Trial):
    loops = clean.loops
    counts = {len(make_trial(seed).loops.ids) for seed in range(12)}
    assert min(counts) >= 60
    assert max(counts) <= 110
    assert len(counts) > 5
    assert len(set(loops.ids)) == len(loops.ids)
    assert set(np.unique(loops.current)) == {0.0, 0.1, 0.2, 0.3, 0.4}
    assert sorted(clean.run_order) == list(range(1, len(loops.ids) + 1))
    assert list(clean.run_order) != sorted(clean.run_order)
    assert np.mean(loops.temperature) == pytest.approx(40.0, abs=4.0)
    assert np.std(loops.temperature) == pytest.approx(10.0, abs=3.0)


def test_motion_is_a_sine_on_the_grid_of_loops(clean: Trial):
    loops = clean.loops
    phase = 2.0 * np.pi * np.arange(360) / 360
    omega = 2.0 * np.pi * loops.frequency
    for derivative, channel in enumerate((loops.displacement, loops.velocity, loops.acceleration)):
        expected = evaluate(loops.harmonics, phase, derivative=derivative, omega=omega)
        np.testing.assert_allclose(channel, expected, atol=1e-12 * np.max(np.abs(expected)))


def test_without_effects_the_truth_is_w11_s_model():
    clean = make_trial(SEED, design=replace(STANDARD, points=720))
    valve = build(Generalized, clean.truth.parameters)
    model = np.asarray(valve.force(loop_motion(clean.loops)))
    np.testing.assert_allclose(model, clean.truth.force, atol=1e-8 * np.max(model))
    for symbol in ("F_0", "a_0", "k_4"):
        ratio = clean.truth.parameters[symbol] / LOW_SYMMETRIC[symbol]
        assert 0.8 < ratio < 1.25
        assert ratio != 1.0
    assert clean.truth.parameters["k_1c"] == clean.truth.parameters["k_1e"]


def test_noise_and_errors_of_the_rig(clean: Trial):
    loops, truth = clean.loops, clean.truth
    assert np.sqrt(np.mean(loops.noise_floor**2)) == pytest.approx(9.0, rel=0.02)
    cycles = np.stack(loops.deviations)
    assert cycles.shape == (len(loops.ids), 8, 360)
    np.testing.assert_allclose(cycles.mean(axis=1), 0.0, atol=1e-9)
    assert np.std(truth.gain) == pytest.approx(6e-3, rel=0.25)
    assert np.std(truth.offset) == pytest.approx(2.0, rel=0.25)
    assert np.std(truth.delay) == pytest.approx(1e-4, rel=0.25)
    step = 1.0 / (360 * loops.frequency)
    slope = (np.roll(truth.force, -1, 1) - np.roll(truth.force, 1, 1)) / (2.0 * step[:, None])
    errors = (
        truth.gain[:, None] * truth.force + truth.offset[:, None] - truth.delay[:, None] * slope
    )
    left = loops.force - truth.force - errors
    assert np.sqrt(np.mean(left**2)) == pytest.approx(9.0 / np.sqrt(8.0), rel=0.1)


def test_relative_noise_follows_the_test(clean: Trial):
    noisy = make_trial(SEED, design=replace(STANDARD, relative_noise=0.1, noise=0.0)).loops
    rms = np.sqrt(np.mean(clean.truth.force**2, axis=1))
    np.testing.assert_allclose(noisy.noise_floor / rms, 0.1, rtol=0.15)


@pytest.mark.parametrize("points", [72, 144, 240, 360])
def test_points_are_means_over_phase_bins(points):
    """What is shorter than a point is neither hit nor missed."""
    rod, k = find_planter("rod_play"), 720 // points
    coarse, fine = (
        make_trial(SEED, (rod,), (1.0,), replace(STANDARD, points=n)).truth.force
        for n in (points, 720)
    )
    whole = np.tile(fine, 3)
    for j in (0, 1, points // 2, points - 1):
        middle = 720 + j * k
        around = whole[:, middle - k // 2 : middle + k // 2 + 1]
        mean = around.mean(axis=1) if k % 2 else np.trapezoid(around, axis=1) / k
        np.testing.assert_allclose(coarse[:, j], mean, atol=1e-9)


def test_a_grid_that_is_no_part_of_the_fine_one_is_refused():
    with pytest.raises(DataError, match="100 points"):
        make_trial(SEED, design=replace(STANDARD, points=100))


def test_a_seed_names_a_campaign_whatever_is_hidden_in_it(clean: Trial):
    again = make_trial(SEED)
    other = make_trial(SEED, (find_planter("oil_column"),), (2.0,))
    for field in fields(clean.loops):
        mine, same = getattr(clean.loops, field.name), getattr(again.loops, field.name)
        assert np.array_equal(mine, same), field.name
    assert other.loops.ids == clean.loops.ids
    added = other.truth.force - clean.truth.force
    gain = 1.0 + clean.truth.gain[:, None]
    seen = other.loops.force - clean.loops.force
    assert np.sqrt(np.mean((seen - gain * added) ** 2)) < 0.01 * np.sqrt(np.mean(added**2))
    assert make_trial(SEED + 1).loops.ids != clean.loops.ids


def test_sizes_are_as_defined_each_alone():
    planters = tuple(find_planter(name) for name in ("gas_chamber", "late_sampling"))
    truth = make_trial(SEED, planters, (1.0, 2.0)).truth
    assert truth.sizes == pytest.approx((1.0, 2.0), rel=0.01)
    assert truth.causes == ("gas_spring", "gas_polytropic", "force_delay")
    assert truth.families == ("reactive", "timing")
    assert truth.nominal[1] == {"size": truth.planters[1].size}
    alone = make_trial(SEED, planters[1:], (2.0,)).truth
    reached = np.sqrt(np.mean((alone.force - alone.force_without) ** 2))
    assert reached / np.sqrt(np.mean(alone.force_without**2)) == pytest.approx(0.02, rel=0.05)
    with pytest.raises(DataError, match="1 sizes were given for 2 planters"):
        make_trial(SEED, planters, (1.0,))


def test_the_truth_does_not_show_when_printed():
    trial = make_trial(SEED, (find_planter("oil_column"),), (2.0,))
    assert repr(trial.truth) == "TrialTruth()"


def test_history_is_in_the_cycles():
    trial = make_trial(SEED, (find_planter("settled_particles"),), (3.0,))
    cycles = np.stack(trial.loops.deviations)
    sign = np.sign(trial.loops.velocity)[:, None, :]
    strength = np.mean(cycles * sign, axis=(0, 2))
    assert np.all(np.diff(strength) < 0.0)
    np.testing.assert_allclose(cycles.mean(axis=1), 0.0, atol=1e-9)


def test_misfit_multiplies_the_laws_smoothly(clean: Trial):
    small, large = (
        make_trial(SEED, design=replace(STANDARD, misfit=size)).truth.force_without
        for size in (0.01, 0.02)
    )
    base = clean.truth.force
    first, second = small - base, large - base
    assert 0.002 < np.sqrt(np.mean(first**2) / np.mean(base**2)) < 0.05
    assert np.sqrt(np.mean((second - 2.0 * first) ** 2) / np.mean(second**2)) < 0.1


def test_misfit_fields_have_unit_variance_and_correlation_over_the_range():
    a = np.full(3, 12.5e-3)
    f = np.array([1.0, 1.1, 14.0])
    i = np.full(3, 0.2)
    draws = np.stack([law_factors(0.1, a, f, i, seed).width[:, 0] for seed in range(600)])
    g = (draws - 1.0) / 0.1
    assert np.std(g) == pytest.approx(1.0, rel=0.1)
    correlation = np.corrcoef(g.T)
    assert correlation[0, 1] > 0.99
    distance = np.log(14.0) / np.log(150.0) / 0.6
    assert correlation[0, 2] == pytest.approx(np.exp(-0.5 * distance**2), abs=0.1)
    assert np.all(law_factors(0.0, a, f, i, 1).gain == 1.0)


def test_another_model_class():
    trial = make_trial(SEED, design=replace(STANDARD, model="bouc_wen"))
    other = make_trial(SEED + 1, design=replace(STANDARD, model="bouc_wen"))
    assert 0.5e-3 < trial.truth.parameters["x_y"] < 1.0e-3
    assert trial.truth.parameters != other.truth.parameters
    assert "F_0" not in trial.truth.parameters
    strong = trial.loops.current == 0.4
    assert 500.0 < np.max(np.abs(trial.truth.force[strong])) < 3000.0
    work = np.mean(trial.truth.force * trial.loops.velocity, axis=1)
    assert np.all(work > 0.0)
    with pytest.raises(DataError, match="point by point"):
        make_trial(SEED, (find_planter("soft_mount"),), design=replace(STANDARD, model="bouc_wen"))


@pytest.mark.parametrize(
    ("name", "limit"), [("bent_load_cell", 2.0), ("soft_seal", 4.0), ("soft_mount", 140.0)]
)
def test_a_hidden_effect_costs_not_much_more_than_the_campaign(name: str, limit: float):
    """Twice what was measured, as a multiple of the same campaign without an effect, which takes
    some 30 ms: a soft mount is an equation to solve at every instant."""
    design = replace(STANDARD, fewest=110)
    planter = find_planter(name)

    def seconds(*effects: Planter) -> float:
        used = []
        for _ in range(3):
            start = time.process_time()
            make_trial(SEED, effects, (2.0,) * len(effects), design)
            used.append(time.process_time() - start)
        return min(used)

    assert seconds(planter) < limit * seconds()
