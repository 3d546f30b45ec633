import numpy as np
import pytest

from sysid.uncertainty.doubt import doubt_of
from sysid.uncertainty.reduced import (
    APART,
    MANY,
    ROWS,
    Reduced,
    at_few_points,
    reduce_likelihood,
)
from sysid.uncertainty.target import (
    exact_log_likelihood,
    few_points,
    harmonics_at,
    target_of,
)


def places(made, count, wide, seed):
    root = np.linalg.cholesky(np.linalg.inv(made.errors.information + np.eye(7)))
    z = np.random.default_rng(seed).standard_normal((count, 7))
    return made.errors.u + wide * z @ root.T


@pytest.fixture(scope="module")
def doubt(made):
    return doubt_of(made.prior.coordinates, made.errors)


@pytest.fixture(scope="module")
def reduced(made, doubt):
    centre = harmonics_at(made.prior, made.errors.observed, made.errors.u[None])[0]
    draws = harmonics_at(made.prior, made.errors.observed, places(made, 200, 1.5, 0))
    errors = made.errors
    return reduce_likelihood(errors.observed, errors.covariance, centre, draws, doubt.weights)


def test_few_numbers_say_what_all_harmonics_say(made, reduced, doubt):
    target = target_of(made.prior, made.errors, reduced, doubt)
    u = places(made, 100, 1.0, 1)
    exact = exact_log_likelihood(made.prior, made.errors, u)
    assert np.ptp(exact) > 5.0
    assert target.log_likelihood(u) == pytest.approx(exact, abs=5e-3)
    assert reduced.a.size < 40


def test_what_is_neglected_never_makes_a_place_less_probable(made, reduced, doubt):
    target = target_of(made.prior, made.errors, reduced, doubt)
    u = places(made, 100, 30.0, 2)
    exact = exact_log_likelihood(made.prior, made.errors, u)
    found = target.log_likelihood(u)
    fine = np.isfinite(exact)
    assert (found[fine] >= exact[fine] - 1e-6 * np.abs(exact[fine])).all()
    assert np.max(found[fine] - exact[fine]) > 1.0


def test_a_walker_is_worth_the_same_in_whatever_company_it_comes(made, reduced, doubt):
    target = target_of(made.prior, made.errors, reduced, doubt)
    u = places(made, 50, 1.0, 3)
    together = target(u)
    assert np.array_equal(together[7:9], target(u[7:9]))
    u[3] = 1e6
    assert target(u)[3] == -np.inf
    assert np.array_equal(np.delete(target(u), 3), np.delete(together, 3))


def test_a_model_without_memory_is_computed_at_few_points_to_the_same_end(made, reduced, doubt):
    few = few_points(made.prior, made.errors, reduced, places(made, 300, 1.5, 0))
    assert few.points.size < len(reduced.B) / 3
    target = target_of(made.prior, made.errors, few, doubt)
    u = places(made, 100, 1.0, 1)
    exact = exact_log_likelihood(made.prior, made.errors, u)
    assert target.log_likelihood(u) == pytest.approx(exact, abs=2e-2)


def test_forces_that_few_points_do_not_tell_are_computed_at_all_of_them():
    rng = np.random.default_rng(0)
    whole = Reduced(rng.standard_normal((500, 4)), np.zeros(4), 0.0, np.arange(500))
    assert at_few_points(whole, rng.standard_normal((100, 500))) is None
    smooth = rng.standard_normal((100, 6)) @ rng.standard_normal((6, 500))
    few = at_few_points(whole, smooth, count=20)
    assert few is not None
    assert len(set(few.points.tolist())) == 20
    assert few.points.size == ROWS  # one compiled program for any number of them
    expected = whole.a - smooth @ whole.B
    assert few.a - smooth[:, few.points] @ few.B == pytest.approx(expected, abs=1e-6)


def test_few_points_are_never_as_many_as_all():
    """Their number tells `motion_at` whether they are all in order."""
    rng = np.random.default_rng(0)
    whole = Reduced(rng.standard_normal((ROWS, 4)), np.zeros(4), 0.0, np.arange(ROWS))
    smooth = rng.standard_normal((100, 6)) @ rng.standard_normal((6, ROWS))
    few = at_few_points(whole, smooth, count=20)
    assert few is not None
    assert few.points.size == 20


def many_points(point: int | None) -> tuple[Reduced, np.ndarray]:
    """Forces at so many points that not all are looked at first, and a number that depends on all
    of them, or on what happens at one point alone."""
    rng = np.random.default_rng(0)
    count = (MANY + 1) * 20
    forces = rng.standard_normal((100, 6)) @ rng.standard_normal((6, count))
    if point is not None:
        forces[:, point] = 3.0 * rng.standard_normal(100)
    return Reduced(rng.standard_normal((count, 4)), np.zeros(4), 0.0, np.arange(count)), forces


def test_of_many_points_some_are_looked_at_first():
    whole, forces = many_points(None)
    few = at_few_points(whole, forces, count=20)
    assert few is not None
    assert not (few.points % APART).any()


def test_what_only_a_point_between_these_tells_is_found_all_the_same():
    point = 10 * APART + 1
    whole, forces = many_points(point)
    few = at_few_points(whole, forces, count=20)
    assert few is not None
    assert point in few.points
    expected = whole.a - forces @ whole.B
    assert few.a - forces[:, few.points] @ few.B == pytest.approx(expected, abs=1e-6)
