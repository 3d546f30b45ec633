"""What a remainder varies with, and the term proposed for it, where the answer is known."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.anova import anova
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.leftover import variables
from sysid.diagnosis.parity import parity_shares
from sysid.diagnosis.proposal import CERTAIN, LIBRARY, WORTH, proposal
from sysid.diagnosis.remainder import Remainder
from sysid.diagnosis.state import State
from sysid.diagnosis.unexplained import unexplained
from sysid.identification.families import FAMILIES
from sysid.identification.problem import loop_problem
from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import GlsFit
from sysid.likelihood.reml import Restricted
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import specs, values
from tests.diagnosis.test_invariance import finer
from tests.diagnosis.test_lack_of_fit import campaign

NOISE = 5.0
PARAMETERS = 13  # of the symmetric model, all but three of which do nothing here


def base(x, v, a, A, f, i):
    """What the model says, with right parameters."""
    return (200 + 1500 * i) * np.tanh(v / 0.01) + 300 * v


def left_by(added, noise=NOISE, seed=0):
    """A campaign whose model lacks a force; its parameters may change plateau and viscosity."""
    loops = campaign(lambda *z: base(*z) + added(*z), noise=noise, seed=seed)
    evidence = gather(loops)
    x, v, i = loops.displacement, loops.velocity, loops.current[:, None]
    step = np.tanh(v / 0.01)
    model = base(x, v, None, None, None, i)
    compress = evidence.basis.compress
    jacobian = np.zeros((*evidence.measured.shape, PARAMETERS))
    jacobian[:, :, :3] = np.stack([compress(z) for z in (step, i * step, v)], axis=2)
    sizes = Sizes(gain=0.0, offset=0.0, delay=0.0)
    covariance = Covariance(evidence.parts, sizes)
    residual, u = compress(loops.force - model), np.zeros(PARAMETERS)
    gls = GlsFit(u, 1.0, residual, jacobian, np.eye(PARAMETERS), 1, True)
    coordinates = GeneralizedCoordinates(loop_problem(loops).reference, "symmetric")
    fitted = Restricted(sizes, covariance, 0.0, np.zeros(8))
    return evidence, State(DamperCoordinates(coordinates, ()), gls, fitted, 0.0)


def shares(found):
    return {q.quantity: q for q in found.quantities}


# -- with what it varies -------------------------------------------------------------------------


def test_a_hardening_spring_depends_on_position():
    found = anova(*left_by(lambda x, v, a, A, f, i: 2e4 * x * np.abs(x)))
    assert found is not None
    assert found.quantities[0].quantity == "position"
    assert found.explained > 0.6, "the largest stroke has to be extrapolated"
    assert shares(found)["position"].share > 0.7 * found.explained
    assert sum(q.share for q in found.quantities) == pytest.approx(
        found.explained - found.constant, abs=1e-9
    )


def test_friction_of_the_field_depends_on_velocity_and_current_together():
    found = anova(*left_by(lambda x, v, a, A, f, i: 800 * i**2 * v / (np.abs(v) + 0.05)))
    assert found is not None
    assert {q.quantity for q in found.quantities[:2]} == {"velocity", "current"}
    assert {found.pairs[0].first, found.pairs[0].second} == {"velocity", "current"}
    assert found.pairs[0].share > 0.3
    assert shares(found)["position"].share < 0.05


def test_side_load_acts_by_position_and_velocity_together():
    found = anova(*left_by(lambda x, v, a, A, f, i: 2000 * x * np.sign(v)))
    assert found is not None
    assert {found.pairs[0].first, found.pairs[0].second} == {"position", "velocity"}
    one, other = (shares(found)[q] for q in ("position", "velocity"))
    assert one.only > 0.8
    assert other.only > 0.8
    assert max(one.alone, other.alone) < 0.1, "neither says anything without the other"


def test_what_tests_at_one_frequency_cannot_tell_apart_is_not_told_apart():
    """a = −ω²x where ω never changes: either stands in for the other."""
    evidence, state = left_by(lambda x, v, a, A, f, i: 3000 * x)
    various = shares(anova(evidence, state))
    assert various["acceleration"].alone < 0.3 * various["position"].alone
    motion = evidence.motion
    as_at_1_hz = motion.acceleration / motion.frequency**2
    motion = eqx.tree_at(lambda m: m.acceleration, motion, as_at_1_hz)
    same = shares(anova(replace(evidence, motion=motion), state))
    assert same["position"].alone > 0.8
    assert same["acceleration"].alone == pytest.approx(same["position"].alone, abs=0.05)
    assert same["position"].only < 0.1 * same["position"].alone
    assert same["acceleration"].only < 0.1 * same["acceleration"].alone
    assert same["position"].share == pytest.approx(same["acceleration"].share, abs=0.1)


def test_noise_varies_with_nothing():
    found = anova(*left_by(lambda *z: 0.0))
    assert found is not None
    assert found.explained < 0.05
    assert found.pairs == ()


# -- what is proposed ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("formula", "coefficient", "added"),
    [
        ("x|x|", 2e4, lambda x, v, a, A, f, i: 2e4 * x * np.abs(x)),
        ("|i|·x", 4e3, lambda x, v, a, A, f, i: 4e3 * i * x),
        ("x·sign(v)", 1e3, lambda x, v, a, A, f, i: 1e3 * x * np.sign(v)),
        ("v|v|", 600.0, lambda x, v, a, A, f, i: 600.0 * v * np.abs(v)),
        ("|i|·|v|", -700.0, lambda x, v, a, A, f, i: -700.0 * i * np.abs(v)),
    ],
)
def test_a_planted_term_is_recovered_with_its_coefficient(formula, coefficient, added):
    first, *others = proposal(*left_by(added))
    assert first.formula == formula
    assert first.coefficient == pytest.approx(coefficient, abs=4 * first.sd)
    assert first.sd < 0.1 * abs(coefficient)
    assert 0.3 < first.removes <= 1.0
    assert first.agreed > 0.8
    assert others == []


def test_two_terms_are_recovered_the_larger_first():
    found = proposal(*left_by(lambda x, v, a, A, f, i: 2e4 * x * np.abs(x) + 800 * x * np.sign(v)))
    assert {t.formula for t in found} == {"x|x|", "x·sign(v)"}
    assert found[0].removes > found[1].removes
    exact = {"x|x|": 2e4, "x·sign(v)": 800.0}
    for term in found:
        assert term.coefficient == pytest.approx(exact[term.formula], abs=4 * term.sd)


def test_what_the_parameters_can_do_is_not_proposed():
    """More viscosity and more plateau are the model's own business."""
    assert proposal(*left_by(lambda x, v, a, A, f, i: 80 * v + 40 * np.tanh(v / 0.01))) == ()


def test_noise_proposes_hardly_ever_anything():
    """A false proposal in one campaign of twenty would be a rate of 5 %: 3 in 60 are allowed."""
    evidence, state = left_by(lambda *z: 0.0)
    random = np.random.default_rng(5)
    false = 0
    for _ in range(60):
        noise = random.standard_normal(state.gls.residual.shape)
        # gain errors from test to test, which no term explains, beside noise
        gain = 0.006 * random.standard_normal((evidence.tests, 1)) * evidence.measured
        state.gls.residual[:] = 2.0 * noise + gain
        false += bool(proposal(evidence, state))
    assert false <= 3


@pytest.mark.parametrize(("size", "proposed"), [(2e4, True), (200.0, False)])
def test_a_term_that_is_too_small_is_not_proposed(size, proposed):
    found = proposal(*left_by(lambda x, v, a, A, f, i: size * x * np.abs(x)))
    assert bool(found) == proposed
    for term in found:
        assert term.removes > WORTH
        assert term.removes > CERTAIN * term.se


def test_a_term_that_one_condition_alone_supports_is_not_proposed():
    """A fault of one test is no law: what it suggests fails on the others."""
    added = lambda x, v, a, A, f, i: np.where(np.isclose(A, 0.05), 60.0 * np.sign(v) * v**2, 0.0)  # noqa: E731
    for term in proposal(*left_by(added)):
        assert term.removes < 0.5


@pytest.mark.parametrize("candidate", LIBRARY, ids=lambda c: c.formula)
def test_terms_have_the_parity_they_claim(candidate):
    loops = campaign(
        lambda x, v, a, A, f, i: candidate.force(x, np.round(v, 9), a, i), currents=(0.2, 0.4)
    )
    assert parity_shares(loops.force)[candidate.parity] == pytest.approx(1.0, abs=1e-3)


# -- in the answer -------------------------------------------------------------------------------


def test_an_unknown_carries_both_and_a_small_remainder_neither():
    evidence, state = left_by(lambda x, v, a, A, f, i: 2e4 * x * np.abs(x))
    residual = state.gls.residual @ evidence.basis.columns.T
    energy = evidence.energy(state.gls.residual)
    large, small = (Remainder(energy, floor, 0.0, 0.0) for floor in (0.05 * energy, 0.999 * energy))
    told = unexplained(evidence, state, large, large, residual)
    assert told.present
    assert told.anova is not None
    assert [t.formula for t in told.proposal] == ["x|x|"]
    silent = unexplained(evidence, state, small, small, residual)
    assert not silent.present
    assert (silent.anova, silent.proposal) == (None, ())


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.name)
def test_the_parameter_that_moves_is_told_of_every_model(family):
    """Also where parameters stand in tables: their symbols are no names of fields."""
    evidence, state = left_by(lambda x, v, a, A, f, i: 2e4 * x * np.abs(x))
    coordinates = family.coordinates_for((loop_problem(evidence.loops),), family.variants[0])
    u = jnp.full(coordinates.size, 0.3)
    symbols = [s.symbol for s in specs(coordinates.valve(u))]
    free = np.array([symbols.index(symbol) for symbol in coordinates.free])
    slopes = np.asarray(jax.jacfwd(lambda z: values(coordinates.valve(z))[free])(u))
    random = np.random.default_rng(0)
    sensitivity = random.normal(size=(*evidence.measured.shape, free.size))
    k = free.size // 2
    sensitivity[:, :, k] = random.normal(size=evidence.measured.shape)
    residual = sensitivity[:, :, k] * random.normal(size=(evidence.tests, 1))
    gls = replace(state.gls, u=np.asarray(u), residual=residual, jacobian=sensitivity @ slopes)
    told = unexplained(
        evidence, replace(state, coordinates=DamperCoordinates(coordinates, ()), gls=gls),
        Remainder(1.0, 0.0, 0.0, 0.0), Remainder(1.0, 0.0, 0.0, 0.0),
        np.ones((evidence.tests, 72)) * evidence.peak[:, None],
    )  # fmt: skip
    assert told.moves == coordinates.free[k]


@pytest.mark.parametrize("points", [360, 500])
def test_what_a_force_may_depend_on_is_known_on_the_points_that_are_simulated(points):
    """Whether or not the grid of the loops is a multiple of theirs."""
    loops = campaign(base)
    coarse, fine = (variables(gather(z, points=72)) for z in (loops, finer(loops, points)))
    for name in ("position", "velocity", "acceleration"):
        here, there = getattr(coarse, name), getattr(fine, name)
        np.testing.assert_allclose(there, here, atol=1e-9 * np.abs(here).max())
