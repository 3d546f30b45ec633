"""The score test: χ²₁ where nothing is, right sizes where something is, blind where it must be."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import kstest

from sysid.diagnosis.evidence import gather
from sysid.diagnosis.prototypes import shape_grid
from sysid.diagnosis.scores import FALSE_ALARM, INVISIBLE, allowed, score_all
from sysid.effects.registry import EFFECTS, effect_kind, make
from sysid.identification.fit import fit_loops
from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import Covariance, Sizes, covariance_parts
from sysid.models.damper import Damper
from sysid.parameters import specs
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from tests.diagnosis.test_lack_of_fit import POINTS, campaign
from tests.likelihood.dense import dense

# Cheap to compile, and of four parities.
FEW = tuple(
    make(effect_kind(name))
    for name in ("force_offset", "gas_spring", "fluid_inertia", "position_friction",
                 "asymmetric_gain", "load_cell_gain")
)  # fmt: skip
# what the rig of the trials has: 0.6 % gain, 2 N offset, 0.1 ms delay from test to test
RIG = Sizes(gain=6e-3, offset=2.0, delay=1e-4, odd=1e-6, even=1e-6)
DESIGN = TrialDesign(fewest=60, most=60)


@cache
def screened(seed, planters=(), percents=None):
    """All of `FEW` on a trial; id → what the score test says of it, best first; and the trial."""
    trial = make_trial(seed, planters, percents, DESIGN)
    evidence = gather(trial.loops)
    fit = fit_loops(trial.loops, variant="symmetric")
    residual, jacobian = evidence.look(fit.coordinates, fit.u)
    shapes = [shape for e in FEW for shape in shape_grid(e, evidence.size)]
    signatures = np.stack([evidence.signature(Damper(fit.valve, (e,))) for e in shapes], axis=2)
    covariance = Covariance(evidence.parts, RIG)
    found = score_all(shapes, signatures, residual, jacobian, covariance)
    return {c.effect.facts.id: c for c in found}, trial


@pytest.mark.parametrize("seed", [11, 12])
def test_nothing_planted_nothing_found(seed):
    found, _ = screened(seed)
    assert len(found) == len(FEW)
    assert all(c.score < c.threshold for c in found.values())


@pytest.mark.parametrize(
    ("planter", "cause"),
    [
        ("gas_preload", "force_offset"),
        ("large_gas_chamber", "gas_spring"),
        ("oil_column", "fluid_inertia"),
        ("side_load", "position_friction"),
        ("bent_load_cell", "asymmetric_gain"),
    ],
)
def test_what_was_planted_comes_first(planter, cause):
    found, trial = screened(21, (find_planter(planter),), (2.0,))
    first = next(iter(found.values()))
    assert first.effect.facts.id == cause
    assert first.score > 5 * first.threshold
    assert cause in trial.truth.causes


def test_expected_size_is_near_the_planted_stiffness():
    """The linear part of a large gas chamber is a spring; the score test's own size finds it."""
    found, trial = screened(21, (find_planter("large_gas_chamber"),), (2.0,))
    added = trial.truth.force - trial.truth.force_without
    x = trial.loops.displacement
    stiffness = float(np.sum(added * x) / np.sum(x * x))
    assert found["gas_spring"].expected == pytest.approx(stiffness, abs=4 * found["gas_spring"].se)


def test_gain_of_the_load_cell_is_invisible():
    """The base model's own force scale absorbs it exactly."""
    found, _ = screened(11)
    gain = found["load_cell_gain"]
    assert not gain.visible
    assert gain.score == 0.0
    assert gain.survival < 1e-3 * INVISIBLE


def test_signature_of_a_spring_is_its_displacement():
    _, trial = screened(11)
    evidence = gather(trial.loops)
    fit = fit_loops(trial.loops, variant="symmetric")
    found = evidence.signature(Damper(fit.valve, (make(effect_kind("gas_spring")),)))
    expected = evidence.basis.compress(trial.loops.displacement)
    np.testing.assert_allclose(found, expected, atol=1e-9)


# -- calibration, on draws from a known Σ -------------------------------------------------------

BASIS = harmonic_basis(POINTS)
SIZES = Sizes(gain=0.01, offset=2.0, delay=1e-4, odd=0.03, even=0.01)
DRAWS = 400


@pytest.fixture(scope="module")
def null():
    """Parts of Σ, draws from it [draw, L, m], a Jacobian, and one candidate of either sign.

    It looks like a spring, but has the name of an effect that may be negative.
    """
    loops = campaign(
        lambda x, v, a, A, f, i: (200 + 1500 * i) * np.tanh(v / 0.01) + 300 * v, noise=5.0
    )
    parts = covariance_parts(loops, BASIS)
    root = np.linalg.cholesky(dense(parts, SIZES))
    random = np.random.default_rng(3).standard_normal((DRAWS, root.shape[0]))
    draws = (random @ root.T).reshape(DRAWS, *parts.force.shape)
    compress = BASIS.compress
    jacobian = np.stack([parts.force, compress(loops.velocity), compress(loops.velocity**3)], 2)
    spring = make(effect_kind("position_friction"))
    return parts, draws, jacobian, spring, compress(loops.displacement)


def scores_of(null, sizes, planted=0.0):
    parts, draws, jacobian, spring, signature = null
    covariance = Covariance(parts, sizes)
    found = [
        score_all([spring], signature[:, :, None], r + planted * signature, jacobian, covariance)[0]
        for r in draws
    ]
    return [np.array([getattr(c, name) for c in found]) for name in ("score", "expected", "se")]


def test_score_is_chi_squared_of_one_degree_where_nothing_is(null):
    score, expected, se = scores_of(null, SIZES)
    assert kstest(score, "chi2", args=(1,)).pvalue > 0.01
    assert np.std(expected / se) == pytest.approx(1.0, abs=4 / np.sqrt(2 * DRAWS))


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_covariance_of_the_wrong_size_is_told_by_the_scores(null, factor):
    """Too narrow a Σ gives scores that are too large, too wide a one too small."""
    parts, *others = null
    wrong = Sizes(*(factor * getattr(SIZES, n) for n in ("gain", "offset", "delay", "odd", "even")))
    scaled = (replace(parts, noise=factor * parts.noise), *others)
    score, expected, se = scores_of(scaled, wrong)
    assert np.std(expected / se) == pytest.approx(1.0 / factor, rel=4 / np.sqrt(2 * DRAWS))
    assert kstest(score, "chi2", args=(1,)).pvalue < 1e-4


def test_leaving_the_structural_term_out_of_the_covariance_finds_ghosts(null):
    plain = Sizes(gain=SIZES.gain, offset=SIZES.offset, delay=SIZES.delay)
    _, expected, se = scores_of(null, plain)
    assert np.std(expected / se) > 2.0


def test_a_planted_size_is_recovered_within_its_standard_errors(null):
    stiffness = 400.0
    _, expected, se = scores_of(null, SIZES, stiffness)
    assert np.mean(expected) == pytest.approx(stiffness, abs=4 * se[0] / np.sqrt(DRAWS))
    covered = np.mean(np.abs(expected - stiffness) < 1.96 * se)
    assert covered == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / DRAWS))


def test_the_threshold_counts_every_shape(null):
    """With k shapes the smallest p-value must be below α/k."""
    parts, draws, jacobian, spring, signature = null
    covariance = Covariance(parts, SIZES)
    one = score_all([spring], signature[:, :, None], draws[0], jacobian, covariance)[0]
    thrice = np.repeat(signature[:, :, None], 3, axis=2)
    many = score_all([spring] * 3, thrice, draws[0], jacobian, covariance)
    assert len(many) == 1, "shapes of one effect are one candidate"
    assert many[0].score == pytest.approx(one.score)
    assert one.threshold == pytest.approx(6.6349, abs=1e-3), "χ²₁ at 1 %"
    assert many[0].threshold == pytest.approx(8.6154, abs=2e-3), "at 1/3 %"
    assert FALSE_ALARM == 0.01


def test_what_the_model_absorbs_scores_nothing(null):
    parts, draws, jacobian, spring, _ = null
    absorbed = jacobian[:, :, :1] + 0.5 * jacobian[:, :, 1:2]
    found = score_all([spring], absorbed, draws[0], jacobian, Covariance(parts, SIZES))[0]
    assert not found.visible
    assert found.score == 0.0


@pytest.mark.parametrize("id", ["backlash", "gas_spring", "fluid_inertia"])
def test_a_size_that_cannot_be_negative_scores_nothing(null, id):
    """No gap has a negative width, no spring of a gas or mass pushes: half of the draws ask so."""
    parts, draws, jacobian, _, signature = null
    one = make(effect_kind(id))
    assert allowed(one, 1.0)
    assert not allowed(one, -1.0)
    found = scores_of((parts, draws, jacobian, one, signature), SIZES)
    score, expected, _ = found
    np.testing.assert_array_equal(score > 0.0, expected > 0.0)
    assert np.mean(score > 0.0) == pytest.approx(0.5, abs=4 * 0.5 / np.sqrt(DRAWS))
    assert kstest(score[score > 0.0], "chi2", args=(1,)).pvalue > 0.01


@pytest.mark.parametrize("kind", EFFECTS, ids=lambda kind: kind.facts.id)
def test_an_effect_may_have_the_sign_that_it_is_scored_at(kind):
    """What occurs with both signs may have both; what the catalogue gives one sign has that one."""
    facts, spec = kind.facts, next(s for s in specs(kind) if s.symbol == kind.facts.size)
    low, high = facts.realistic[facts.size]
    nominal = facts.nominal[facts.size]
    one = make(kind)
    assert allowed(one, nominal)
    assert allowed(one, -nominal) == (low < 0.0 < high)
    assert facts.sign in (0, np.sign(nominal))
    assert facts.sign == 1 or spec.low != 0.0
