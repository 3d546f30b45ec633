"""Figures of errors, intervals, recipes, loops side by side, and laws that warm."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.identification.result import TestError
from sysid.identification.straight_lines.bias import Bias
from sysid.isolator.compare import Band, Change
from sysid.report.bias_plot import plot_bias
from sysid.report.error_plot import plot_errors
from sysid.report.family_plot import plot_family
from sysid.report.intervals_plot import WIDEST, plot_intervals
from sysid.report.warm_laws_plot import plot_warm_laws
from sysid.uncertainty.estimate import Estimate, Estimates
from tests.report.made_page import many_loops


def test_errors_stand_at_their_speed_beside_the_noise_of_the_mean_cycle():
    loops, _ = many_loops(10)
    errors = [
        TestError(name, 1.0, 0.01 * (k + 1), 99.0, 11.0, k % 5 == 0, k % 5 > 0)
        for k, name in enumerate(loops.ids)
    ]
    ax = plot_errors((loops, errors[::-1]))  # in any order
    floor, fitted, held = ax.lines
    assert [z.get_label() for z in ax.lines] == ["noise of the mean cycle", "fitted", "held out"]
    np.testing.assert_allclose(held.get_ydata(), [1.0, 6.0])
    np.testing.assert_allclose(fitted.get_xdata()[:4], loops.peak_velocity[1:5])
    peak = np.abs(loops.force).max(axis=1)
    np.testing.assert_allclose(floor.get_ydata(), 100.0 * 11.0 / np.sqrt(5.0) / peak)
    assert "(m/s)" in ax.get_xlabel()
    assert "% of max|F|" in ax.get_ylabel()


def estimates(*ends: tuple[float, float]) -> Estimates:
    rows = [
        Estimate(f"p{k}", "", "N", 2.0, 0.1, low, high, identified=True)
        for k, (low, high) in enumerate(ends)
    ]
    return Estimates(tuple(rows), tuple(p.symbol for p in rows), np.eye(len(rows)), "a rule", ())


def test_intervals_are_parts_of_the_value_and_what_is_cut_has_an_arrow():
    ax = plot_intervals(((estimates((1.9, 2.2), (0.0, 9.0)),), {"p0": 2.1, "p1": 50.0}))
    first, second = (z.get_xdata() for z in ax.lines if z.get_linewidth() == 2.0)
    np.testing.assert_allclose(first, [-5.0, 10.0])
    np.testing.assert_allclose(second, [-100.0 * WIDEST, 100.0 * WIDEST])
    assert {"<", ">"} <= {str(z.get_marker()) for z in ax.lines}
    (truth,) = [z for z in ax.lines if z.get_label() == "truth"]
    np.testing.assert_allclose(truth.get_xdata(), [5.0])  # the other one lies beyond the axis
    assert ax.get_xlabel().endswith("/ %")


def test_bias_has_a_line_for_each_current_that_was_meant():
    loops, _ = many_loops(10)
    rng = np.random.default_rng(0)
    scattered = loops.current + rng.normal(0.0, 6e-3, 10)
    values = {name: 0.01 * k for k, name in enumerate(loops.ids)}
    ax = plot_bias((replace(loops, current=scattered), Bias({}, values, {}), "yield_force"))
    assert len(ax.get_legend().get_texts()) == 5
    assert ax.get_ylabel().startswith("F_y")
    assert ax.get_xlabel() == "temperature / °C"


@pytest.mark.parametrize(
    ("over", "name"), [("velocity", "(m/s)"), ("displacement", "from the centre / mm")]
)
def test_loops_side_by_side_are_closed_and_named(over, name):
    loops, force = many_loops(3)
    ax = plot_family((loops, ["a", "b", "c"], force), over=over)
    assert [z.get_label() for z in ax.lines if not z.get_label().startswith("_")] == [
        "a", "b", "c", "model",
    ]  # fmt: skip
    for line in ax.lines:
        assert line.get_xdata()[0] == line.get_xdata()[-1]
    assert name in ax.get_xlabel()
    assert "compression positive" in ax.get_xlabel()


def test_laws_that_warm_have_whiskers_only_where_an_interval_is_known():
    nan = float("nan")
    known, unknown = Band(0.1, 0.08, 0.13, nan, nan), Band(-0.2, nan, nan, nan, nan)
    ax = plot_warm_laws(
        ({"C_post": (Change("P", 2000.0, known, known),),
          "k": (Change("P", 2000.0, unknown, unknown),)}, "acceleration")
    )  # fmt: skip
    heights = [bar.get_height() for bar in ax.patches]
    np.testing.assert_allclose(heights, [10.0, -20.0])
    ((first, second),) = [z.get_segments() for z in ax.collections]
    np.testing.assert_allclose(first[:, 1], [8.0, 13.0])
    assert not np.isfinite(second).any()
    assert ax.get_ylabel() == "change of RMS acceleration / %"
