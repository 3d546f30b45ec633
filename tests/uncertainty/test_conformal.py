"""Conformal bands count what they promise, whatever the errors are like."""

import dataclasses

import numpy as np
import pytest

from sysid.likelihood.gls import gauss_newton
from sysid.motion.motion import loop_motion
from sysid.uncertainty.conformal import (
    conditions_needed,
    conformal,
    jackknife_plus,
    upper_quantile,
    weights_of,
)
from sysid.uncertainty.left_out import leave_conditions_out

CONDITIONS, POINTS = 24, 12


def hit(rng: np.random.Generator, *, scores: float = 1.0, away: float = 1.0) -> bool:
    """One campaign of a level that is its mean; is a whole loop at a new condition inside.

    Errors of conditions have heavy tails and are common to their loops; `away` makes the new
    condition unlike the others, `scores` the band narrower or wider than it should be.
    """
    count = rng.integers(1, 6, CONDITIONS + 1)
    condition = np.repeat(np.arange(CONDITIONS + 1), count)
    shared = rng.standard_t(2, CONDITIONS + 1)
    shared[-1] *= away
    loops = 50.0 + shared[condition, None] + rng.standard_normal((condition.size, POINTS))
    known = condition < CONDITIONS
    old, condition = loops[known], condition[known]
    without = np.stack([old[condition != c].mean() for c in range(CONDITIONS)])
    reach = scores * np.abs(old - without[condition, None]).max(axis=1)
    predicted = np.broadcast_to(without[:, None], (CONDITIONS, POINTS))
    low, high = jackknife_plus(predicted, reach, condition, 0.95)
    new = loops[~known][0]
    return bool(np.all((new >= low) & (new <= high)))


@pytest.mark.parametrize(
    ("change", "least", "most"),
    [
        ({}, 0.93, 0.985),
        ({"scores": 1.5}, 0.97, 1.0),
        ({"scores": 0.5}, 0.0, 0.9),
        ({"away": 10.0}, 0.0, 0.85),
    ],
    ids=["as it is", "too wide", "too narrow", "a condition unlike the others"],
)
def test_a_whole_loop_at_a_new_condition_is_inside_as_often_as_promised(change, least, most):
    rng = np.random.default_rng(0)
    assert least <= np.mean([hit(rng, **change) for _ in range(1000)]) <= most


def test_nineteen_conditions_are_needed_for_95_per_cent_and_then_the_worst_decides():
    assert conditions_needed(0.95) == 19
    assert conditions_needed(0.9) == 9
    values = np.arange(19.0)
    assert upper_quantile(values, weights_of(np.arange(19)), 0.95) == 18.0
    assert upper_quantile(values[:18], weights_of(np.arange(18)), 0.95) == np.inf
    # of 39 conditions, the next to worst
    assert upper_quantile(np.arange(39.0), weights_of(np.arange(39)), 0.95) == 37.0


def test_a_condition_counts_as_one_however_many_tests_it_has():
    condition = np.array([0, 1, 1, 1, 1])
    assert weights_of(condition) == pytest.approx([1 / 3, 1 / 12, 1 / 12, 1 / 12, 1 / 12])
    few = upper_quantile(np.array([5.0, 1.0, 2.0, 3.0, 4.0]), weights_of(condition), 0.5)
    assert few == 5.0


@pytest.fixture(scope="module")
def left_out(made):
    return leave_conditions_out(made.errors, made.fit.coordinates)


def test_noise_is_that_of_the_cycles_whatever_a_likelihood_takes_for_it(made, left_out):
    """Which only scales scores: bands need no likelihood."""
    parts = made.errors.observed.parts
    larger = dataclasses.replace(parts, noise=7.0 * parts.noise)
    observed = dataclasses.replace(made.errors.observed, parts=larger)
    other = leave_conditions_out(
        dataclasses.replace(made.errors, observed=observed), made.fit.coordinates
    )
    assert other.noise == left_out.noise


def test_a_condition_is_predicted_without_itself(made, left_out):
    errors, coordinates = made.errors, made.fit.coordinates
    assert sorted(set(left_out.condition)) == list(range(9))
    measured = errors.observed.measured.copy()
    third = left_out.condition == 3
    measured[third] *= 1.2
    spoiled = dataclasses.replace(
        errors, observed=dataclasses.replace(errors.observed, measured=measured)
    )
    again = leave_conditions_out(spoiled, coordinates)
    # fits stop within a tenth of a standard error
    sd = np.sqrt(np.diagonal(np.linalg.inv(errors.information)))
    assert (np.abs(again.u[3] - left_out.u[3]) / sd).max() < 0.2
    assert (np.abs(again.u[0] - left_out.u[0]) / sd).max() > 2.0
    kept = ~third

    def look(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, jacobian = errors.observed.look(coordinates, u)
        return residual[kept], jacobian[kept]

    covariance = type(errors.covariance)(errors.observed.parts.of(kept), errors.sizes)
    exact = gauss_newton(look, errors.u + 0.3 * sd, covariance, tolerance=1e-9)
    assert (np.abs(exact.u - left_out.u[3]) / sd).max() < 0.2


def test_free_static_forces_are_in_no_prediction(made, left_out, monkeypatch):
    """A prediction tells what is usual of a loop: with a preload in it, bands are too narrow."""
    coordinates = made.fit.coordinates
    monkeypatch.setattr(type(coordinates), "statics_free", property(lambda self: True))
    free = leave_conditions_out(made.errors, coordinates)
    np.testing.assert_array_equal(free.predicted, left_out.predicted)
    np.testing.assert_allclose(np.ptp(free.measured - left_out.measured, axis=1), 0.0, atol=1e-9)
    np.testing.assert_allclose((free.measured - free.predicted).mean(axis=1), 0.0, atol=1e-9)


def test_few_conditions_give_words_and_no_number(made, left_out):
    found = conformal(left_out)
    assert found.band(made.fit.coordinates, loop_motion(made.loops)) is None
    assert found.score is None
    assert "9 conditions (amplitude, frequency) are too few" in found.words
    assert "it takes 19" in found.words


def test_at_a_level_that_they_allow_the_band_holds_the_tests_it_was_made_of(made, left_out):
    found = conformal(left_out, 0.85)
    assert "with probability 0.7 at least, and about 0.85" in found.words
    band = found.band(made.fit.coordinates, loop_motion(made.loops))
    assert band is not None
    inside = band.holds(made.loops.force).all(axis=1)
    assert inside.mean() >= 0.85
    # white noise of 2 % in four cycles: about three standard deviations of 1 %
    rms = np.sqrt(np.mean(made.loops.force**2, axis=1))
    half = 0.5 * np.mean(band.high - band.low, axis=1) / rms
    assert (half > 0.02).all()
    assert (half < 0.06).all()
    assert found.score == pytest.approx(3.0, abs=0.8)
