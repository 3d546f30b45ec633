"""Intervals from Σ: exact for linear models, right, too narrow and too wide; open where bent."""

from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np
import pytest
from scipy import stats

from sysid.identification.fit import fit_loops
from sysid.likelihood.discrepancy import LAWS, NAMES, Covariance, Parts, Sizes
from sysid.models.generalized import LOW_SYMMETRIC
from sysid.parameters import specs, values
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.uncertainty.covariance import OPEN, independent, sandwich
from sysid.uncertainty.declared import Declared
from sysid.uncertainty.error_model import errors_at
from sysid.uncertainty.propagated import by_eq_11, by_gls
from sysid.uncertainty.sample import observed_of
from sysid.uncertainty.side_by_side import side_by_side
from sysid.uncertainty.spread import LEAST_FREEDOM, OF_SHAPE, known_slopes
from tests.identification.campaigns import FIVE_CURRENTS, LOW_DESIGN, virtual_loops
from tests.likelihood.dense import draw
from tests.uncertainty.one_spread import spread_of

SIZES = Sizes(0.006, 2.0, 1e-4, 1e-3, 1e-3, 0.02, 0.03, 0.01, 0.02, 0.0)


@dataclass(frozen=True)
class Linear:
    """Loops whose model is linear in three parameters, with all that Σ is made of."""

    parts: Parts
    jacobian: np.ndarray


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan, 1e200])
def test_slopes_that_are_no_numbers_say_nothing(value):
    slopes = np.ones((2, 3, 4))
    slopes[1, 2, 0] = value
    found = known_slopes(slopes)
    assert not found[..., 0].any()
    np.testing.assert_array_equal(found[..., 1:], slopes[..., 1:])


@pytest.fixture(scope="module")
def linear() -> Linear:
    rng = np.random.default_rng(0)
    loops, order = 24, np.concatenate([[0], np.repeat(np.arange(1, 6), 2)])
    shape = (loops, order.size)
    place = rng.uniform(0.0, 1.0, (loops, 2))
    apart = np.sum((place[:, None] - place[None]) ** 2, axis=2)
    falling = 1.0 / (1.0 + order**2)
    parts = Parts(
        noise=np.full(loops, 0.3),
        force=300.0 * falling * rng.standard_normal(shape),
        rate=3e3 * falling * rng.standard_normal(shape),
        scale=np.full(loops, 300.0),
        order=order,
        kernel=np.exp(-0.5 * apart / 0.4**2) + 1e-8 * np.eye(loops),
        laws=200.0 * falling * rng.standard_normal((4, *shape)),
        error=0.05,
    )
    return Linear(parts, 100.0 * falling[:, None] * rng.standard_normal((*shape, 3)))


def held(linear: Linear, estimator: str, believed: Sizes) -> float:
    """Share of 95 % intervals that hold the truth, errors drawn with `SIZES`."""
    parts, J = linear.parts, linear.jacobian
    G = Covariance(parts, believed).weighted(J) if estimator == "gls" else J
    H = np.einsum("lmi,lmj->ij", J, G)
    spread = spread_of(H, G, parts, believed)
    half = spread.quantile * np.sqrt(np.diagonal(spread.covariance))
    hits = [
        np.abs(np.linalg.solve(H, np.einsum("lmi,lm->i", G, draw(parts, SIZES, seed)))) < half
        for seed in range(300)
    ]
    return float(np.mean(hits))


@pytest.mark.parametrize("estimator", ["least squares", "gls"])
def test_intervals_hold_the_truth_as_often_as_they_say(linear, estimator):
    """Right; too narrow where laws are taken to be exact; too wide where twice as wrong."""
    low, high = stats.binom.ppf([0.0005, 0.9995], 300, 0.95) / 300
    exact = replace(SIZES, **dict.fromkeys((*LAWS, "odd", "even"), 0.0))
    wrong = replace(SIZES, **{n: 2.5 * getattr(SIZES, n) for n in (*LAWS, "gain", "delay")})
    assert low <= held(linear, estimator, SIZES) <= high
    assert held(linear, estimator, exact) < low
    if estimator == "least squares":
        assert held(linear, estimator, wrong) > high


def test_gls_is_the_best_there_is_and_its_covariance_the_inverse_information(linear):
    parts, J = linear.parts, linear.jacobian
    covariance = Covariance(parts, SIZES)
    information, G = covariance.inner(J, J), covariance.weighted(J)
    gls = spread_of(information, G, parts, SIZES).covariance
    # what is too small to be heard is left out of Σ⁻¹
    np.testing.assert_allclose(gls, np.linalg.inv(information), rtol=2e-3)
    ordinary = spread_of(np.einsum("lmi,lmj->ij", J, J), J, parts, SIZES).covariance
    assert (np.diagonal(gls) < np.diagonal(ordinary)).all()


@pytest.mark.parametrize("name", ["gain", "scale", "odd"])
def test_one_size_that_is_known_from_few_errors_gives_students_t(linear, name):
    """ln s of a size estimated from ν errors has the standard deviation 1/√(2ν); of smooth errors
    nobody knows it better than the shape of their covariance."""
    only = replace(Sizes(0.0, 0.0, 0.0), **{name: 0.05})
    quiet = replace(linear.parts, noise=np.full(24, 1e-6))
    H = np.einsum("lmi,lmj->ij", linear.jacobian, linear.jacobian)
    of_shape = 0.0 if name == "gain" else OF_SHAPE

    def quantile(spread: float) -> np.ndarray:
        unsure = np.zeros(len(NAMES))
        unsure[NAMES.index(name)] = spread
        return spread_of(H, linear.jacobian, quiet, only, unsure).quantile

    for freedom in (5.0, 40.0, 1e6):
        left = 1.0 / (1.0 / freedom + 2.0 * of_shape**2)
        found = quantile(1.0 / np.sqrt(2.0 * freedom))
        np.testing.assert_allclose(found, stats.t.ppf(0.975, left), rtol=1e-3)
    np.testing.assert_allclose(quantile(3.0), stats.t.ppf(0.975, LEAST_FREEDOM))
    known = spread_of(H, linear.jacobian, quiet, only).quantile
    np.testing.assert_allclose(known, stats.norm.ppf(0.975), rtol=1e-6)


def test_a_direction_without_data_is_open(linear):
    J = np.concatenate([linear.jacobian, linear.jacobian[:, :, :1]], axis=2)
    covariance = spread_of(np.einsum("lmi,lmj->ij", J, J), J, linear.parts, SIZES).covariance
    sd = np.sqrt(np.diagonal(covariance))
    assert (sd[[0, 3]] > 1e3).all()
    assert (sd[[1, 2]] < 1.0).all()
    both = np.array([1.0, 0.0, 0.0, 1.0])
    assert np.sqrt(both @ covariance @ both) < 1.0


@pytest.fixture(scope="module")
def campaign():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.02, seed=3)
    # gains that are known to 1 %
    gain = 1.0 + 0.01 * np.random.default_rng(0).standard_normal((20, 1))
    loops = replace(loops, force=loops.force * gain)
    return loops, fit_loops(loops, variant="symmetric")


@pytest.fixture(scope="module")
def found(campaign):
    return side_by_side(campaign[1], campaign[0])


def test_slopes_by_declared_parameters_are_differences(campaign):
    loops, fit = campaign
    theta = np.asarray(values(fit.valve))
    free = [k for k, s in enumerate(specs(fit.valve)) if s.symbol in fit.coordinates.free]
    relative = Declared.beside(fit.valve, fit.coordinates, np.abs(theta[free]))
    observed = observed_of(fit, loops)
    _, jacobian = observed.look(relative, np.zeros(relative.size))
    np.testing.assert_allclose(relative.locate(relative.valve(jnp.full(13, 0.1))), 0.1, rtol=1e-9)
    for k, symbol in enumerate(relative.free):
        step = 1e-5 * np.eye(relative.size)[k]
        up, down = (observed.residual(relative, z) for z in (step, -step))
        expected = (down - up) / 2e-5
        np.testing.assert_allclose(
            jacobian[:, :, k], expected, atol=1e-5 * np.abs(expected).max(), err_msg=symbol
        )


def test_the_cards_interval_is_that_of_the_fitted_values(campaign, found):
    _, fit = campaign
    by_symbol = {p.symbol: p for p in found.card.parameters}
    assert "Eq. 11 under errors of rig and laws" in found.card.interval
    assert found.because is None
    assert by_symbol["F_0"].value == float(fit.valve.F_0)
    assert by_symbol["k_1e"] == replace(
        by_symbol["k_1c"], symbol="k_1e", name=by_symbol["k_1e"].name
    )
    assert by_symbol["k_5"].sd == 0.0
    # a gain error of 1 % in each of 20 tests
    plain = {p.symbol: p for p in independent(fit).parameters}
    for symbol in ("a_1", "a_4", "k_1c"):
        assert by_symbol[symbol].sd > 3.0 * plain[symbol].sd, symbol


def test_a_straight_parameter_has_straight_ends_and_a_bent_one_its_profiles(campaign, found):
    loops, fit = campaign
    straight = {p.symbol: p for p in by_eq_11(fit, loops, found.errors, bent=False).parameters}
    bent = {p.symbol: p for p in found.card.parameters}
    for symbol in ("F_0", "a_1", "a_4"):
        assert bent[symbol].low == pytest.approx(straight[symbol].low, rel=0.02), symbol
        assert bent[symbol].high == pytest.approx(straight[symbol].high, rel=0.02), symbol
    a = bent["a_0"]
    assert a.high - a.value > 1.05 * (a.value - a.low)


def test_what_is_not_identified_to_first_order_is_not_along_its_profile(campaign, found):
    straight = by_eq_11(campaign[1], campaign[0], found.errors, bent=False)
    open_ones = {p.symbol for p in straight.parameters if not p.identified}
    assert open_ones
    assert open_ones <= {p.symbol for p in found.card.parameters if not p.identified}


def test_all_rules_stand_side_by_side(campaign, found):
    rules = [e.interval for e in found.all]
    assert len(set(rules)) == len(rules) == 4  # four conditions are too few to leave out in turn
    for word in ("Eq. 11", "generalised", "tests", "independent"):
        assert any(word in rule for rule in rules), word
    gls = next(e for e in found.beside if "generalised" in e.interval)
    sd = {p.symbol: p.sd for p in gls.parameters}
    own = {p.symbol: p.sd for p in found.card.parameters}
    assert all(sd[s] < own[s] for s in ("a_1", "a_4", "k_1c", "k_0"))
    assert gls.interval == by_gls(campaign[1], found.errors).interval


def test_where_there_is_no_covariance_a_sandwich_takes_its_place(campaign, monkeypatch):
    loops, fit = campaign
    monkeypatch.setattr("sysid.uncertainty.side_by_side.MOST", 19)
    found = side_by_side(fit, loops)
    assert found.because is not None
    assert "at most 19 tests" in found.because
    assert found.errors is None
    np.testing.assert_array_equal(found.card.covariance, sandwich(fit).covariance)


def test_errors_of_laws_make_the_cards_intervals_wider(campaign):
    """Force scale wrong by a smooth few percent: errors are found, and the interval knows them."""
    loops, fit = campaign
    bend = 1.0 + 0.03 * np.sin(3.0 * np.log(loops.frequency) + 8.0 * loops.current)[:, None]
    wrong = replace(loops, force=loops.force * bend)
    again = fit_loops(wrong, variant="symmetric")
    errors = errors_at(again, observed_of(again, wrong))
    before = {
        p.symbol: p.sd
        for p in by_eq_11(
            fit, loops, errors_at(fit, observed_of(fit, loops)), bent=False
        ).parameters
    }
    after = {p.symbol: p.sd for p in by_eq_11(again, wrong, errors, bent=False).parameters}
    for symbol in ("a_1", "k_1c"):
        assert after[symbol] > 2.0 * before[symbol], symbol


def test_what_only_the_fitted_value_lets_look_determined_is_not_identified():
    """The loop's width bends with current early or late: k_3 = 3.5 and 9.6 fit almost alike."""
    trial = make_trial(61_000_048, design=TrialDesign(fewest=110, most=110))
    fit = fit_loops(trial.loops, variant="symmetric")
    errors = errors_at(fit, observed_of(fit, trial.loops))
    found = by_eq_11(fit, trial.loops, errors, bent=False)
    width = next(p for p in found.parameters if p.symbol == "k_3")
    assert trial.truth.parameters["k_3"] > width.high
    assert width.sd < OPEN * width.value
    assert not width.identified
    assert any(z.startswith("k_3 looks determined at its fitted value") for z in found.undetermined)
    # as if Σ's own values were the fitted ones: nothing beside the fit is left to doubt it
    alone = by_eq_11(fit, trial.loops, replace(errors, u=np.asarray(fit.u)), bent=False)
    both = zip(found.parameters, alone.parameters, strict=True)
    assert [p.symbol for p, q in both if p.identified != q.identified] == ["k_3"]
