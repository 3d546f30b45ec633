"""Effects that only the cycles of a test show: found, sized, told from drifts, and taken out."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.cards.extended import card_of_diagnosis
from sysid.data.loops import Loops
from sysid.diagnosis.cycle_candidates import followed
from sysid.diagnosis.cycle_evidence import gather_cycles
from sysid.diagnosis.cycle_fit import Scatter, fit_change, inner, log_determinant
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.prototypes import NEED_CYCLES
from sysid.diagnosis.result import Diagnosis, Quantity, ScreenRow
from sysid.diagnosis.steady_state import without
from sysid.diagnosis.within_tests import Within, look_within
from sysid.effects.registry import effect_kind
from sysid.models.generalized import Generalized
from sysid.motion.motion import loop_motion
from sysid.parameters import build
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import Trial, make_trial
from tests.diagnosis.diagnosed import DESIGN, diagnosed
from tests.diagnosis.test_invariance import doubled


def trial(seed: int, *names: str, percent: float = 1.0) -> Trial:
    planters = tuple(find_planter(name) for name in names)
    return make_trial(seed, planters, (percent,) * len(planters), DESIGN)


def look(one: Trial, loops: Loops | None = None) -> Within:
    """With the valve that made the tests: what its fit would err by plays no part here."""
    return look_within(gather(loops or one.loops), valve_of(one))


def valve_of(one: Trial) -> Generalized:
    return build(Generalized, one.truth.parameters)


def changed(loops: Loops, change: list[np.ndarray]) -> Loops:
    """With something added to the cycles of each test, [cycles, J] N."""
    pairs = zip(loops.deviations, change, strict=True)
    return replace(loops, deviations=tuple(d + c - c.mean(axis=0) for d, c in pairs))


def parameter(within: Within, symbol: str) -> Quantity:
    return next(q for q in within.parameters if q.symbol == symbol)


@pytest.fixture(scope="module")
def noise() -> Trial:
    return trial(201)


@pytest.fixture(scope="module")
def settled() -> Trial:
    return trial(202, "settled_particles")


@pytest.fixture(scope="module")
def found(settled: Trial) -> Within:
    return look(settled)


@pytest.mark.parametrize("seed", range(211, 219))
def test_noise_is_no_effect(seed):
    within = look(trial(seed))
    assert within.tests == 60
    assert within.effect is None
    assert within.unnamed is None
    assert all(row.score < row.threshold for row in within.screen)


def test_breakaway_is_found_with_its_size(settled, found):
    (planter,) = settled.truth.planters
    assert found.members == ("first_cycle_breakaway",)
    half_over = planter.size * np.exp(-0.5 / planter.stirring)
    assert parameter(found, "F_br").value == pytest.approx(half_over, rel=0.05)
    assert parameter(found, "n_br").value == pytest.approx(planter.stirring, rel=0.05)
    assert found.confidence > 0.85
    assert found.stability == 1.0


def test_heating_is_found_with_its_size():
    one = trial(203, "heated_oil")
    within = look(one)
    assert within.members == ("self_heating",)
    found = parameter(within, "r_h")
    assert found.value == pytest.approx(one.truth.planters[0].size, rel=0.15)
    assert found.identified


def test_what_is_left_of_one_effect_shows_the_other():
    one = trial(204, "settled_particles", "heated_oil")
    first = look(one)
    assert first.members == ("first_cycle_breakaway",)
    assert first.effect is not None
    second = look(one, without(one.loops, valve_of(one), first.effect)[0])
    assert second.members == ("self_heating",)


def test_what_is_left_of_one_effect_is_no_other(settled, found):
    assert found.effect is not None
    assert look(settled, without(settled.loops, valve_of(settled), found.effect)[0]).effect is None


def test_cells_that_drift_are_no_effect(noise):
    """Gains of half a per cent and zeros of 3 N, straight over the test and of random sign."""
    random = np.random.default_rng(5)
    line = np.linspace(-1.0, 1.0, 8)[:, None]
    change = [
        line * (0.005 * random.normal() * force + 3.0 * random.normal())
        for force in noise.loops.force
    ]
    within = look(noise, changed(noise.loops, change))
    assert within.effect is None
    assert within.unnamed is None


def test_an_amplifier_that_warms_up_is_told_without_a_name(noise):
    course = np.exp(-np.arange(8) / 2.0)[:, None]
    within = look(noise, changed(noise.loops, [0.03 * course * f for f in noise.loops.force]))
    assert within.effect is None
    assert within.unnamed == "a gain that goes with the number of the cycle"


def test_one_condition_alone_is_no_cause(noise):
    """Friction of 60 N in the first cycle, but of one condition."""
    condition = gather(noise.loops).condition
    course = 60.0 * np.exp(-np.arange(8) / 2.0)[:, None]
    change = [
        course * np.tanh(v / 1e-3) * (c == condition[30])
        for v, c in zip(noise.loops.velocity, condition, strict=True)
    ]
    assert look(noise, changed(noise.loops, change)).effect is None


def test_copies_of_cycles_are_no_evidence_and_do_not_count(settled, found):
    twice = look(settled, doubled(settled.loops))
    assert twice.tests == found.tests
    for one, other in zip(twice.parameters, found.parameters, strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-6)
        assert one.sd == pytest.approx(other.sd, rel=1e-4)
    assert found.effect is not None
    valve = valve_of(settled)
    whole, half = (
        without(z, valve, found.effect)[0] for z in (doubled(settled.loops), settled.loops)
    )
    np.testing.assert_allclose(whole.force, half.force, atol=1e-6)


def test_too_few_cycles_say_nothing(settled):
    few = tuple(d[:2] - d[:2].mean(axis=0) for d in settled.loops.deviations)
    paths = tuple(d[:2] for d in settled.loops.displacement_deviations)
    short = replace(
        settled.loops, deviations=few, displacement_deviations=paths,
        cycles=np.full(60, 2),
    )  # fmt: skip
    assert look(settled, short).screen == ()


def test_what_the_model_makes_of_a_larger_first_stroke_is_taken_out(noise):
    loops, valve = noise.loops, valve_of(noise)
    motion = loop_motion(loops)
    fields = ("displacement", "velocity", "acceleration", "peak_velocity")
    larger = replace(motion, **{name: 1.05 * getattr(motion, name) for name in fields})
    more = np.asarray(valve.force(larger) - valve.force(motion))
    first = (np.arange(8) == 0)[:, None]
    paths = tuple(
        d + 0.05 * (first - first.mean()) * x
        for d, x in zip(loops.displacement_deviations, loops.displacement, strict=True)
    )
    without, with_ = (gather(z) for z in (loops, changed(loops, [first * f for f in more])))
    told = replace(with_, loops=replace(with_.loops, displacement_deviations=paths))
    found = []
    for e in (without, with_, told):
        cycles = gather_cycles(e.loops, e.basis, e.condition)
        assert cycles is not None
        found.append(followed(e, cycles, valve).change)
    quiet, loud, mended = found
    assert np.std(mended - quiet) < 0.05 * np.std(loud - quiet)


def test_what_is_taken_out_is_what_was_planted(settled, found):
    """The mean over cycles, and the change from cycle to cycle, which is no noise."""
    assert found.effect is not None
    steady, force = without(settled.loops, valve_of(settled), found.effect)
    taken = settled.loops.force - steady.force
    planted = settled.truth.force - settled.truth.force_without
    assert np.sqrt(np.mean((taken - planted) ** 2)) < 0.1 * np.sqrt(np.mean(planted**2))
    assert force == pytest.approx(np.sqrt(np.mean(planted**2)), rel=0.1)
    assert np.median(settled.loops.noise_floor) > 1.3 * DESIGN.noise
    assert np.median(steady.noise_floor) == pytest.approx(DESIGN.noise, rel=0.03)


def test_likelihood_is_that_of_the_dense_covariance(noise):
    """The diagonal basis against the matrix of each test, written out over cycles and harmonics."""
    evidence = gather(noise.loops)
    cycles = gather_cycles(noise.loops, evidence.basis, evidence.condition)
    assert cycles is not None
    few = np.arange(3)
    cut = {
        name: getattr(cycles, name)[few]
        for name in ("tests", "counts", "change", "own", "trend", "shape", "least", "condition")
    }
    cycles = replace(cycles, rows=cycles.rows[:3], **cut)
    m = cycles.shape.shape[1]
    spectrum = np.linspace(1.5, 0.5, m)
    scatter = Scatter(np.array([0.4, 0.5, 0.6]), spectrum, gain=(0.004, 0.006), zero=(0.3, 0.5))
    found = inner(cycles, scatter, cycles.change, cycles.change)
    zero = np.zeros(m)
    zero[0] = 1.0
    rests = np.linalg.svd(np.ones((1, 8)))[2][1:]
    determinant = 0.0
    for k in few:
        trend = np.outer(cycles.trend[k], cycles.trend[k])
        dense = np.kron(np.eye(8), np.diag(scatter.noise[k] ** 2 * spectrum))
        for direction, (white, straight) in ((cycles.shape[k], scatter.gain), (zero, scatter.zero)):
            over = white**2 * np.eye(8) + straight**2 * trend
            dense += np.kron(over, np.outer(direction, direction))
        turn = np.kron(rests, np.eye(m))
        dense = turn @ dense @ turn.T
        y = turn @ cycles.change[k].ravel()
        assert found[k] == pytest.approx(y @ np.linalg.solve(dense, y), rel=1e-9)
        determinant += np.linalg.slogdet(dense)[1]
    assert log_determinant(cycles, scatter) == pytest.approx(determinant, rel=1e-9)


def test_scatter_is_recovered(noise):
    evidence = gather(noise.loops)
    random = np.random.default_rng(8)
    line = np.linspace(-1.0, 1.0, 8)[:, None]
    unit = line / np.linalg.norm(line)
    change = [
        0.004 * random.normal(size=(8, 1)) * (f - f.mean())
        + 0.01 * random.normal() * unit * (f - f.mean())
        for f in noise.loops.force
    ]
    loops = changed(noise.loops, change)
    cycles = gather_cycles(loops, evidence.basis, evidence.condition)
    assert cycles is not None
    scatter = fit_change(cycles).scatter
    assert scatter.gain == pytest.approx((0.004, 0.01), rel=0.25)
    assert scatter.zero[0] < 0.5
    assert np.median(scatter.noise) == pytest.approx(
        DESIGN.noise / np.sqrt(DESIGN.points), rel=0.05
    )


@pytest.fixture(scope="module")
def answer(settled: Trial) -> Diagnosis:
    return diagnosed(settled.loops)


@pytest.mark.slow
def test_nothing_else_is_made_of_what_the_cycles_showed(answer):
    (cause,) = answer.causes
    assert cause.id == "first_cycle_breakaway"
    assert cause.from_cycles
    assert answer.answer == "named"
    assert answer.gain is not None
    assert answer.gain.before == pytest.approx(answer.base.held_out_nrmse, rel=1e-9)
    assert answer.gain.after < answer.gain.before
    assert cause.share > 0.95


@pytest.mark.slow
def test_model_and_card_are_of_the_steady_state_and_say_so(settled, answer):
    assert answer.damper.effects == ()
    assert any("steady state after the first cycles" in note for note in answer.notes)
    assert "from cycle to cycle" in answer.sentences[0]
    card = card_of_diagnosis(answer, (), damper="d", campaign="c")
    assert card.effects == ()
    assert any("first_cycle_breakaway" in told for told in card.known_discrepancies)
    twin = make_trial(202, (), None, DESIGN).loops
    before, after = (np.std(z.force - twin.force) for z in (settled.loops, answer.loops))
    assert after < 0.1 * before, "the same tests without settled particles"


def test_scattered_cycles_cannot_show_what_they_do_not(noise):
    """An effect that was looked for and not seen is not listed; one that scatter hides is."""
    evidence = gather(noise.loops)
    quiet = hidden(evidence, (), look(noise))
    assert not {z.id for z in quiet} & set(NEED_CYCLES)
    random = np.random.default_rng(3)
    loud = [1500.0 * random.normal(size=(8, DESIGN.points)) for _ in noise.loops.ids]
    listed = {
        z.id: z.because for z in hidden(evidence, (), look(noise, changed(noise.loops, loud)))
    }
    assert "scatter" in listed["self_heating"]
    none = {z.id: z.because for z in hidden(evidence, (), Within())}
    assert "0 of the tests" in none["first_cycle_breakaway"]


@pytest.mark.parametrize("grown", [0.02, 1.0, 100.0])
def test_what_cycles_can_show_goes_with_the_size_of_the_damper(noise, grown):
    """The same damper, all forces so many times as large: the same answer."""
    loops = noise.loops
    force = grown * loops.force
    evidence = gather(replace(loops, force=force, noise_floor=grown * loops.noise_floor))
    limit = effect_kind("first_cycle_breakaway").facts.realistic["F_br"][1]
    limit *= evidence.size.force / 500.0
    for share, told in ((0.8, False), (1.25, True)):
        row = ScreenRow("first_cycle_breakaway", 0.0, 16.0, 1.0, 0.0, share * limit / 4.0)
        listed = {z.id for z in hidden(evidence, (), Within((row,), tests=60))}
        assert ("first_cycle_breakaway" in listed) == told


def test_temperature_that_some_tests_lack(noise):
    """They would count as tests at 40 °C: no effect of temperature is looked for."""
    some, none = noise.loops.temperature.copy(), np.full(len(noise.loops.ids), np.nan)
    some[:2] = np.nan
    told = [
        {z.id: z.because for z in hidden(gather(replace(noise.loops, temperature=t)), (), Within())}
        for t in (some, none)
    ]
    assert "2 of" in told[0]["surface_temperature"]
    assert "2 of" in told[0]["viscosity_temperature"]
    assert "2 of" in told[0]["gas_temperature"]
    assert "no temperature" in told[1]["viscosity_temperature"]
