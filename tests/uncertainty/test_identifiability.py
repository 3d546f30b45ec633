"""What is said of parameters that the data leave open."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.identification.fit import fit_loops
from sysid.likelihood.observed import observe
from sysid.models.generalized import Generalized
from sysid.parameters import ParamSpec, specs
from sysid.uncertainty.covariance import (
    Grams,
    cluster_jackknife,
    estimate_of,
    grams_of,
    independent,
    sandwich,
    without_idle,
)
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.error_model import error_model
from sysid.uncertainty.identifiability import Identifiability, Known, identifiability
from sysid.uncertainty.profiles import Profile
from sysid.uncertainty.side_by_side import side_by_side

BELOW = "I_0 is below 2 A, and nothing bounds it from below"
ABOVE = "I_0 is above 1 A, and nothing bounds it from above"
TO_ZERO = "k_5 is below 2, and down to its bound 0 nothing holds it"
TO_ONE = "k_5 is above 0.3, and up to its bound 1 nothing holds it"
SPECS = {s.symbol: s for s in specs(Generalized)}


def test_at_zero_current_what_only_current_shows_is_open_and_the_rest_is_known(made):
    """Nothing in the data depends on k_2, a_2, I_0, a_3, I_1 of the default's kind of model."""
    fit = fit_loops(made.loops, variant="symmetric", max_waves=1)
    found = identifiability(fit, error_model(fit, observe(made.loops, points=72), "independent"))
    assert np.isfinite(found.spectrum).all()
    told = " ".join(found.open)
    for symbol in ("k_2", "a_2", "I_0", "a_3", "I_1"):
        assert symbol in told
    assert all(np.isfinite([k.force_sd, k.height_sd]).all() for k in found.known)
    assert found.known[0].force_sd < 0.02 * abs(found.known[0].force)


def profile(spec: ParamSpec, low: float, high: float, closed: tuple[bool, bool]) -> Profile:
    line = np.linspace(0.0, 1.0, 3)
    return Profile(
        spec, 0.5, line, line, np.zeros((3, 1)), (spec.symbol,), low, high, closed
    )  # fmt: skip


@pytest.mark.parametrize(
    ("symbol", "ends", "closed", "said"),
    [
        (
            "I_0",
            (-np.inf, 2.0),
            (False, True),
            BELOW,
        ),
        ("I_0", (1.0, np.inf), (True, False), ABOVE),
        ("I_0", (-np.inf, np.inf), (False, False), "I_0 may have any value: its profile is flat"),
        ("k_5", (0.0, 2.0), (False, True), TO_ZERO),
        ("k_5", (0.3, 1.0), (True, False), TO_ONE),
        ("k_5", (0.3, 0.9), (True, True), None),
    ],
)
def test_an_open_end_is_said_and_how_far_nothing_holds_it(symbol, ends, closed, said):
    spec = replace(SPECS[symbol], high=1.0) if said == TO_ONE else SPECS[symbol]
    one = profile(spec, *ends, closed)
    whole = Identifiability((), np.zeros(0), np.zeros((0, 0)), (), (), 0.01, 1.0, (one,))
    told = [s for s in whole.ends if s.startswith(symbol)]
    assert told == ([said] if said else [])


@pytest.mark.parametrize("value", [0.0, 1e-304, 1e-13])
def test_a_value_that_came_near_its_bound_is_said(value):
    """Solvers work in a coordinate in which the bound is infinitely far away."""
    at_end = estimate_of(SPECS["k_5"], value, 0.1, 1.96)
    inside = estimate_of(SPECS["k_5"], 0.15, 0.1, 1.96)

    def told(one):
        return undetermined(("k_5",), np.array([one.value]), np.array([[0.01]]), (one,))

    assert told(at_end) == ("k_5 ended at its bound 0: its data would rather have less",)
    assert told(inside) == ()


@pytest.mark.parametrize("sd", [1.0, 1e5])
def test_a_value_that_is_hardly_known_is_not_at_its_bound(sd):
    """k_3 = 9.2 is next to nothing of an interval that reaches to a million."""
    spec = SPECS["k_3"]
    open_one = estimate_of(spec, 9.2, 9.2 * sd, 1.96)
    told = undetermined(("k_3",), np.array([9.2]), np.array([[sd**2]]), (open_one,))
    assert not [z for z in told if "bound" in z]
    at_end = estimate_of(spec, 1e-9, spec.typical * sd, 1.96)
    told = undetermined(("k_3",), np.array([1e-9]), np.array([[100.0 * sd**2]]), (at_end,))
    assert [z for z in told if "bound" in z]


def told_of(symbols: tuple[str, ...], *wide: tuple[float, tuple[float, ...]]) -> tuple[str, ...]:
    """Sentences where some directions, each with its relative sd, are wide and others are not."""
    covariance = 1e-4 * np.eye(len(symbols))
    for sd, direction in wide:
        unit = np.array(direction) / np.linalg.norm(direction)
        covariance += sd**2 * np.outer(unit, unit)
    return undetermined(symbols, np.ones(len(symbols)), covariance, ())


def test_parameters_are_told_with_how_many_numbers_they_are_too_many():
    one = told_of(("a", "b", "c"), (2.0, (1.0, 1.2, 1.4)))
    assert one == (
        "c, b and a trade against each other (±200 %): one number too many for these data",
    )
    two = told_of(("a", "b", "c"), (90.0, (1.0, 2.0, 1.0)), (2.0, (1.0, 0.0, -1.0)))
    assert len(two) == 1
    assert two[0].startswith("b, ")
    assert two[0].endswith(
        "trade against each other (±200 % and more): two numbers too many for these data"
    )


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.8])
def test_sentences_do_not_depend_on_how_directions_mix(turn):
    """Two alike wide ones: any two between them say the same."""
    first, second = np.array([1.0, 2.0, 3.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 1.0, 1.2])
    first, second = first / np.linalg.norm(first), second / np.linalg.norm(second)
    c, s = np.cos(turn), np.sin(turn)
    told = told_of(
        ("a", "b", "c", "d", "e"),
        (1e4, tuple(c * first + s * second)), (0.99e4, tuple(c * second - s * first)),
    )  # fmt: skip
    assert sorted(told) == [
        "c, b and a trade against each other (any factor): one number too many for these data",
        "e and d trade against each other (any factor): one number too many for these data",
    ]


def test_two_open_directions_of_two_parameters_leave_neither_known():
    told = told_of(("a", "b", "c"), (90.0, (1.0, 2.0, 0.0)), (80.0, (2.0, -1.0, 0.0)))
    assert sorted(told) == ["a is not determined (any factor)", "b is not determined (any factor)"]


def test_what_hardly_takes_part_in_a_wide_direction_is_told_if_that_moves_it():
    """A hundredth of ten thousand is a hundred."""
    told = told_of(("a", "b", "c"), (1e4, (1.0, 0.01, 1e-6)))
    assert told == (
        "a and b trade against each other (any factor): one number too many for these data",
    )


def test_a_product_that_stays_known_is_told_beside_what_is_not():
    told = told_of(("a", "b", "c"), (90.0, (1.0001, -1.0, 0.0)), (70.0, (0.0, 0.0, 1.0)))
    assert told[0].startswith("a and b run off together (any factor): only a·b = 1 is determined")
    assert told[1:] == ("c is not determined (any factor)",)


def test_parts_without_a_point_are_no_clusters():
    rng = np.random.default_rng(0)
    grams = np.stack([z.T @ z for z in rng.standard_normal((12, 10, 4))])
    points = np.full(12, 10)
    filled = np.concatenate([grams, np.zeros((30, 4, 4))])
    expected = cluster_jackknife(grams, np.arange(12), points)
    found = cluster_jackknife(filled, np.arange(42), np.append(points, np.zeros(30, dtype=int)))
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-9)
    assert found[1] == expected[1] == 12


def test_a_parameter_that_is_as_good_as_gone_is_open_like_one_that_is(made):
    """The last digits of an exponential that underflows are no information."""
    grams, gone = grams_of(made.fit), grams_of(made.fit)
    for rest, of_each in ((1e-140, grams.of_each), (0.0, gone.of_each)):
        of_each[:, 2] *= rest
        of_each[:, :, 2] *= rest
    found = cluster_jackknife(without_idle(grams.of_each), made.fit.condition, grams.points)[0]
    expected = cluster_jackknife(gone.of_each, made.fit.condition, gone.points)[0]
    np.testing.assert_array_equal(found, expected)
    assert np.sqrt(found[2, 2]) == pytest.approx(1e4)
    np.testing.assert_array_equal(without_idle(gone.of_each), gone.of_each)


def test_of_a_parameter_whose_slope_is_no_number_nothing_is_known(made):
    """A fit that failed may have left one where the force's change with it overflows."""
    grams, gone = grams_of(made.fit), grams_of(made.fit)
    for value, of_each in ((np.inf, grams.of_each), (0.0, gone.of_each)):
        of_each[:, 2] = value
        of_each[:, :, 2] = value
    np.testing.assert_array_equal(without_idle(grams.of_each), without_idle(gone.of_each))


def test_a_direction_that_is_none_gives_no_number():
    """Beside variances of 1e16 rounding makes some of a part of a covariance negative."""
    for seed in range(100):
        axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(6, 6)))[0]
        covariance = (axes * np.array([1e16, 3e15, 1e10, 0.0, 0.0, 0.0])) @ axes.T
        told = undetermined(
            tuple("abcdef"), np.ones(6), 0.5 * (covariance + covariance.T), ()
        )  # fmt: skip
        assert told
        assert not [sentence for sentence in told if "nan" in sentence]


def test_what_is_known_is_told_with_its_interval():
    one = Known(0.2, force=100.0, force_sd=1.0, height=10.0, height_sd=20.0)
    whole = Identifiability((), np.zeros(0), np.zeros((0, 0)), (), (one,), 0.01, 1.0, ())
    force, height = whole.ends
    assert force.endswith("is known to ±2 % at 0.2 A (95 %)")
    assert height.endswith("is known to no better than its own size at 0.2 A (95 %)")


def test_of_one_test_a_sandwich_is_that_of_its_points(made):
    """Student's t of one degree of freedom, for an error of many points, is six times too wide."""
    whole = grams_of(made.fit)
    one = Grams(whole.of_each[:1], whole.points[:1])
    alone = replace(made.fit, condition=np.array([0]))
    found, plain = sandwich(alone, grams=one), independent(alone, one)
    assert "independent points" in found.interval
    assert "second test" in found.interval
    assert [(p.low, p.high) for p in found.parameters] == [
        (p.low, p.high) for p in plain.parameters
    ]


@pytest.mark.parametrize("many", [False, True])
def test_of_one_test_no_rule_stands_twice_beside_the_card(made, monkeypatch, many):
    """Nothing can be left out of one: whole conditions, tests and points are one rule then."""
    monkeypatch.setattr("sysid.uncertainty.side_by_side.MOST", 0)  # no Σ: it has nothing to do here
    count = 9 if many else 1
    loops = made.loops.select(np.arange(len(made.loops.ids)) < count)
    found = side_by_side(fit_loops(loops, variant="passive", max_waves=1), loops)
    rules = [e.interval for e in found.all]
    if many:
        assert len(rules) == len(set(rules)) > 1
        assert any("conditions" in rule for rule in rules)
        assert rules[-1].endswith("independent points")
    else:
        assert rules == ["0.95, independent points, for want of a second test"]
