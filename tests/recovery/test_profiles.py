"""Profiles: least cost at every point, ends where chance allows, open where data say nothing."""

from dataclasses import replace

import numpy as np
import pytest
from campaigns import draw_campaign
from scipy.optimize import NonlinearConstraint, minimize

from sysid.identification.fit import fit_loops
from sysid.likelihood.observed import observe
from sysid.uncertainty.covariance import NORMAL
from sysid.uncertainty.error_model import ErrorModel, error_model
from sysid.uncertainty.free_parameters import free_parameters
from sysid.uncertainty.identifiability import identifiability
from sysid.uncertainty.profiles import profiles
from sysid.uncertainty.spread import spread_under

GRID = [(a, f) for a, f in ((2.5e-3, 2.0), (12.5e-3, 0.5), (12.5e-3, 2.0), (25e-3, 1.5))]
CURRENTS = (0.0, 0.1, 0.2, 0.4)


def campaign(currents: tuple[float, ...] = CURRENTS, noise: float = 0.03):
    conditions = np.array([(a, f, i) for a, f in GRID for i in currents]).T
    return draw_campaign(3, table="low", conditions=tuple(conditions), noise=noise).loops


@pytest.fixture(scope="module")
def fitted():
    loops = campaign()
    fit = fit_loops(loops, variant="symmetric")
    return fit, error_model(fit, observe(loops), "independent")


@pytest.fixture(scope="module")
def found(fitted):
    return {p.symbol: p for p in profiles(*fitted)}


def test_every_free_parameter_has_a_profile_through_the_optimum(fitted, found):
    fit, _ = fitted
    assert tuple(found) == fit.coordinates.free
    for p in found.values():
        assert p.rise.min() == pytest.approx(0.0, abs=0.02)
        assert np.all(np.diff(p.values) > 0.0)
        assert p.low < p.best < p.high


def test_along_a_parameter_that_is_linear_the_ends_are_those_of_least_squares(fitted, found):
    fit, errors = fitted
    _, slopes = (np.asarray(z) for z in free_parameters(fit.coordinates, errors.u))
    sd = np.sqrt(np.diagonal(slopes @ np.linalg.inv(errors.information) @ slopes.T))
    for symbol in ("F_0", "k_4"):
        p, k = found[symbol], fit.coordinates.free.index(symbol)
        assert (p.high - p.low) / (2.0 * 1.96 * sd[k]) == pytest.approx(1.0, abs=0.05)
        line = (p.values - p.best) / sd[k]
        near = np.abs(line) < 2.0
        np.testing.assert_allclose(p.root[near], line[near], atol=0.1)


def test_a_covariance_that_is_not_known_makes_a_profile_as_wide_as_all_that_may_be_right(fitted):
    """Under Σ with errors of laws; and as wide as a normal one where it is known."""
    fit, _ = fitted
    errors = error_model(fit, observe(campaign()), "full")
    place, spread = spread_under(fit, errors)
    k = [s.symbol for s in place.declared].index("F_0")
    half = spread.quantile[k] * place.sd(spread)[k]
    narrow = NORMAL * place.magnitude[k] * np.sqrt(spread.plain[k])
    assert half > 1.05 * narrow
    for known, wide in ((False, half), (True, narrow)):
        (p,) = profiles(fit, replace(errors, spread=None) if known else errors, ("F_0",))
        assert (p.high - p.low) / 2.0 == pytest.approx(wide, rel=0.02)


def test_where_the_model_is_bent_each_point_is_still_the_least_cost(fitted, found):
    """k_3, whose interval is the widest: against a general constrained minimiser."""
    fit, errors = fitted
    coordinates, k = fit.coordinates, fit.coordinates.free.index("k_3")
    p = found["k_3"]
    assert (p.high - p.best) > 1.3 * (p.best - p.low)

    def cost(u: np.ndarray) -> tuple[float, np.ndarray]:
        r, J = errors.observed.look(coordinates, u)
        both = np.concatenate([J, r[:, :, None]], axis=2)
        gram = errors.covariance.inner(both, both)
        return float(gram[-1, -1]), -2.0 * gram[:-1, -1]

    least = cost(np.asarray(errors.u))[0]

    def place(u: np.ndarray, which: int) -> np.ndarray:
        """k_3 over its best value, or the slopes of that."""
        return np.asarray(free_parameters(coordinates, u)[which][k]) / p.best

    middle = int(np.argmin(p.rise))
    for at in (middle - 1, middle + 1, 0, -1):
        end = p.values[at] / p.best
        fixed = NonlinearConstraint(
            lambda u: place(u, 0), end, end, jac=lambda u: place(u, 1)[None]
        )
        other = minimize(
            cost, np.asarray(errors.u), jac=True, method="SLSQP", constraints=[fixed],
            bounds=[(z - 3.0, z + 3.0) for z in np.asarray(errors.u)],
            options={"maxiter": 200, "ftol": 1e-9},
        )  # fmt: skip
        assert p.rise[at] <= other.fun - least + 0.05
        if abs(at - middle) == 1:  # further out that minimiser stops short
            assert p.rise[at] == pytest.approx(other.fun - least, abs=0.1)


def test_the_data_decide_how_often_an_interval_holds_the_truth(fitted):
    """Fifty campaigns' noise; right, a likelihood of a tenth of the data, of ten times the data.

    Of 100 intervals of 95 %, fewer than 88 hold the truth once in two hundred times.
    """
    fit, errors = fitted
    clean = errors.observed.measured - errors.observed.residual(fit.coordinates, errors.u)
    truth, _ = free_parameters(fit.coordinates, errors.u)
    chosen = ("k_4", "a_0")
    held = {1.0: 0, 0.1: 0, 10.0: 0}
    width = dict.fromkeys(held, 0.0)
    for seed in range(50):
        noise = np.random.default_rng(seed).standard_normal(clean.shape)
        drawn = clean + errors.observed.parts.noise[:, None] * noise
        for power in held:
            believed: ErrorModel = replace(
                errors, power=power, observed=replace(errors.observed, measured=drawn)
            )
            for p in profiles(fit, believed, chosen):
                true = float(truth[fit.coordinates.free.index(p.symbol)])
                held[power] += p.low <= true <= p.high
                width[power] += (p.high - p.low) / abs(true)
    assert 88 <= held[1.0] <= 100
    assert held[0.1] == 100
    assert held[10.0] < 70
    assert width[0.1] / width[1.0] == pytest.approx(np.sqrt(10.0), rel=0.1)
    assert width[1.0] / width[10.0] == pytest.approx(np.sqrt(10.0), rel=0.1)


def test_what_one_current_cannot_tell_is_open_and_said():
    loops = campaign(currents=(0.2,))
    fit = fit_loops(loops, variant="symmetric")
    errors = error_model(fit, observe(loops), "independent")
    told = {p.symbol: p for p in profiles(fit, errors, ("k_2", "k_4", "a_1"))}
    assert told["a_1"].determined
    assert not told["k_2"].determined
    whole = identifiability(fit, errors, tuple(told.values()))
    assert whole.spectrum[0] > 1.0
    assert any(("k_2" in s and "bounds it" in s) or "k_2 may have" in s for s in whole.sentences)
    force = next(s for s in whole.sentences if s.startswith("The force at"))
    assert force.endswith("at 0.2 A (95 %)")


def test_what_is_read_off_loops_is_known_although_single_parameters_are_not(fitted):
    fit, errors = fitted
    whole = identifiability(fit, errors)
    assert [k.current for k in whole.known] == list(CURRENTS)
    assert whole.spectrum[0] > 20.0 * max(k.force_sd / k.force for k in whole.known)
    assert np.all(np.diff(whole.spectrum) <= 0.0)
    np.testing.assert_allclose(whole.directions @ whole.directions.T, np.eye(13), atol=1e-9)
