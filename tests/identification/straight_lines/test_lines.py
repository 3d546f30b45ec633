"""Intervals of lines cover; changes in per cent; curvature; scatter split by its causes."""

import numpy as np
import pytest

from sysid.identification.straight_lines.curvature import curvature_of, pooled_p
from sysid.identification.straight_lines.independence import independence_of
from sysid.identification.straight_lines.lines import Line, fit_line
from sysid.identification.straight_lines.scatter import split_scatter
from sysid.identification.straight_lines.stage import Reading

T = np.linspace(11.0, 75.0, 9)
TRUE = (1700.0, -9.0)
DRAWS = 500


def drawn(
    rng: np.random.Generator, *, noise: float = 8.0, told: float = 8.0, scatter: float = 0.0
) -> Line:
    y = TRUE[0] + TRUE[1] * T + np.hypot(noise, scatter) * rng.standard_normal(T.size)
    se = told * np.sqrt(rng.chisquare(9, T.size) / 9)
    return fit_line(T, y, se, np.full(T.size, 10.0))


def covered(**how: float) -> np.ndarray:
    """Shares of draws whose intervals of intercept, slope and value at 60 °C hold the truth."""
    rng = np.random.default_rng(11)
    hits = np.zeros(3)
    for _ in range(DRAWS):
        line = drawn(rng, **how)
        (a, b), (c, d) = line.intervals
        y, sd = line.at(np.array([60.0]))
        far = abs(y[0] - TRUE[0] - TRUE[1] * 60.0)
        hits += (a <= TRUE[0] <= b, c <= TRUE[1] <= d, far <= line.quantile * sd[0])
    return hits / DRAWS


def test_intervals_cover_where_standard_errors_are_right():
    found = covered()
    assert (found > 0.93).all()
    assert (found < 0.99).all()


def test_scatter_beyond_the_standard_errors_is_taken_up():
    """Too narrow by a factor of eight, were it not for the scatter that the residuals show."""
    for how in ({"scatter": 20.0}, {"told": 1.0}):
        found = covered(**how)
        assert (found > 0.92).all()
        assert (found < 0.98).all()


def test_standard_errors_that_are_too_large_stay():
    """Residuals smaller than told are no reason to doubt what repetitions say."""
    assert (covered(told=24.0) > 0.998).all()


def test_scatter_is_found():
    rng = np.random.default_rng(2)
    found = [drawn(rng, scatter=20.0).scatter for _ in range(300)]
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(20.0, rel=0.1)
    none = [drawn(rng).scatter for _ in range(300)]
    assert np.mean(np.array(none) == 0.0) > 0.4


def test_a_change_in_per_cent_covers_and_is_infinite_where_its_base_may_be_zero():
    rng = np.random.default_rng(4)
    true = 100.0 * ((TRUE[0] + 75 * TRUE[1]) / (TRUE[0] + 15 * TRUE[1]) - 1.0)
    changes = [drawn(rng).change(15.0, 75.0) for _ in range(DRAWS)]
    hits = np.mean([c.low <= true <= c.high for c in changes])
    assert 0.93 < hits < 0.99
    assert np.mean([c.percent for c in changes]) == pytest.approx(true, abs=0.05)
    still = fit_line(T, rng.standard_normal(T.size), np.ones(T.size), np.full(T.size, 10.0))
    assert still.change(15.0, 75.0).high == np.inf


def test_lines_need_tests_and_temperatures():
    with pytest.raises(ValueError, match="three tests and two temperatures"):
        fit_line(T[:2], T[:2], T[:2], T[:2])
    with pytest.raises(ValueError, match="three tests and two temperatures"):
        fit_line(np.full(5, 40.0), T[:5], T[:5], T[:5])


def test_straight_truths_seldom_bend():
    rng = np.random.default_rng(6)
    lines = [drawn(rng, scatter=8.0) for _ in range(DRAWS)]
    alone = np.array([pooled_p([z]) for z in lines])
    assert 0.03 < np.mean(alone < 0.05) < 0.075
    assert curvature_of(lines[0]).p == pytest.approx(alone[0], rel=1e-9)
    pooled = [pooled_p(lines[k : k + 6]) for k in range(0, DRAWS, 6)]
    assert np.mean(np.array(pooled) < 0.05) < 0.12
    assert np.median(pooled) == pytest.approx(0.5, abs=0.15)


def curve(value: np.ndarray, sd: float) -> Line:
    noise = sd * np.random.default_rng(1).standard_normal(T.size)
    return fit_line(T, value + noise, np.full(T.size, sd), np.full(T.size, 10.0))


def test_curves_are_told_by_name():
    kelvin = T + 273.15
    arrhenius = curvature_of(curve(np.exp(1500.0 / kelvin + 2.0), 1.0))
    assert arrhenius.shown
    assert arrhenius.best.name == "Arrhenius"
    assert arrhenius.best.temperature == pytest.approx(1500.0, rel=0.05)
    vogel = curvature_of(curve(np.exp(100.0 / (T + 20.0) + 4.0), 1.0))
    assert vogel.best.name == "Vogel"
    assert vogel.best.temperature == pytest.approx(-20.0, abs=3.0)
    assert vogel.bend > 0.1
    straight = curvature_of(curve(1700.0 - 9.0 * T, 8.0))
    assert not straight.shown
    assert straight.rivals[0].name == "line"


def test_few_tests_tell_no_curvature():
    line = fit_line(T[:3], np.array([3.0, 2.0, 0.5]), np.ones(3), np.full(3, 10.0))
    assert np.isnan(curvature_of(line).p)
    assert not curvature_of(line).shown


def readings(
    rng: np.random.Generator, current: float, *, choice: float, kelvin: float, more: float = 0.0
) -> list[Reading]:
    """k of one current, each window with an error of its own and a shared one."""
    told = []
    for n, t in enumerate(T):
        felt = t + kelvin * rng.standard_normal()
        k = (1.5e6 + 1.5e5 * felt) * (1.0 + more + 0.002 * rng.standard_normal())
        windows = 1.0 + choice * rng.standard_normal(13) + np.linspace(-0.05, 0.05, 13)
        told.append(
            Reading(
                n, f"{current}A{t}", current, t, k * (windows[6]), 0.002 * k, 10, 0.0, 0.0,
                np.zeros(4, dtype=bool), k * windows,
            )
        )  # fmt: skip
    return told


@pytest.mark.parametrize(("choice", "kelvin"), [(0.01, 0.5), (0.002, 2.0)])
def test_scatter_of_stiffness_is_split(choice, kelvin):
    splits = []
    for seed in range(60):
        rng = np.random.default_rng((3, seed))
        levels = [(i, readings(rng, i, choice=choice, kelvin=kelvin)) for i in (0.8, 1.0, 2.0)]
        found = split_scatter(levels)
        assert found is not None
        splits.append(found)
    assert np.median([s.temperature for s in splits]) == pytest.approx(kelvin, rel=0.25)
    held = [s.temperature_interval[0] <= kelvin <= s.temperature_interval[1] for s in splits]
    assert np.mean(held) >= 0.88
    assert np.median([s.choice for s in splits]) == pytest.approx(choice, rel=0.1)
    assert np.median([s.shared for s in splits]) == pytest.approx(0.0325, rel=0.1)
    assert np.median([s.noise for s in splits]) == pytest.approx(0.002, rel=0.05)


def test_a_told_error_of_temperature_leaves_the_rest_to_the_choice_of_points():
    rng = np.random.default_rng(9)
    levels = [(i, readings(rng, i, choice=0.02, kelvin=0.5)) for i in (0.8, 1.0, 2.0)]
    found = split_scatter(levels, 0.5)
    assert found is not None
    assert (found.told, found.temperature) == (0.5, 0.5)
    assert found.proportional == pytest.approx(0.02, rel=0.4)
    assert split_scatter([(1.0, levels[0][1][:2])]) is None


def test_currents_that_differ_are_told_apart_and_others_are_not():
    rng = np.random.default_rng(10)
    alarms, seen = 0, 0
    for _ in range(100):
        same = [(i, readings(rng, i, choice=0.005, kelvin=0.2)) for i in (0.8, 1.0, 2.0)]
        found = independence_of(same)
        assert found is not None
        alarms += found.shown
        apart = [*same[:2], (2.0, readings(rng, 2.0, choice=0.005, kelvin=0.2, more=0.05))]
        other = independence_of(apart)
        assert other is not None
        seen += other.shown
    assert alarms <= 12
    assert seen >= 95
    assert independence_of(same[:1]) is None
