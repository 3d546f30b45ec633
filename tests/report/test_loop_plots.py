"""Figures show the numbers that they were given."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from sysid.data.cycles import cut_loops
from sysid.data.record import Conditions, Record
from sysid.report.history_plot import history_png, plot_history
from sysid.report.loop_plots import (
    loops_png,
    plot_fit_displacement,
    plot_fit_velocity,
    plot_force_displacement,
    plot_force_velocity,
    worst_png,
)


def record(current: float | None) -> Record:
    t = np.arange(800) / 200
    force = (50.0 + 800.0 * (current or 0.0)) * np.tanh(5.0 * np.cos(4 * np.pi * t))
    x = 0.01 * np.sin(4 * np.pi * t) - 0.03
    return Record(f"{current}", t, x, force, nominal=Conditions(current=current))


@pytest.fixture(scope="module")
def loops():
    return cut_loops([record(0.0), record(0.5), record(None)]).loops


def test_all_loops_are_drawn_closed_in_the_units_of_the_labels(loops):
    velocity, displacement = plot_force_velocity(loops), plot_force_displacement(loops)
    for ax, x in ((velocity, loops.velocity), (displacement, 1e3 * loops.displacement)):
        assert len(ax.lines) == 3
        for k, line in enumerate(ax.lines):
            np.testing.assert_array_equal(line.get_xdata(), np.append(x[k], x[k, 0]))
            np.testing.assert_array_equal(
                line.get_ydata(), np.append(loops.force[k], loops.force[k, 0])
            )
        assert ax.get_ylabel() == "force / N"
    assert "m/s" in velocity.get_xlabel()
    assert "mm" in displacement.get_xlabel()
    assert velocity.lines[2].get_color() == "grey"  # its current is not known
    assert velocity.lines[0].get_color() != velocity.lines[1].get_color()


def test_measured_and_simulated_are_told_apart(loops):
    for plot in (plot_fit_velocity, plot_fit_displacement):
        ax = plot((loops, 1, 0.9 * loops.force[1]))
        measured, simulated = ax.lines
        assert [measured.get_label(), simulated.get_label()] == ["measured", "simulated"]
        np.testing.assert_allclose(simulated.get_ydata(), 0.9 * np.asarray(measured.get_ydata()))


def test_given_axes_are_used(loops):
    ax = plot_force_velocity(loops)
    assert plot_force_displacement(loops, ax=ax) is ax
    assert len(ax.lines) == 6


def test_one_setting_of_the_supply_has_one_colour_and_no_scale(loops, monkeypatch):
    """However it wanders: a scale over microamperes would tell of nothing."""
    shown: list[Figure] = []
    monkeypatch.setattr("sysid.report.loop_plots.png", shown.append)
    alike = loops.select(np.isfinite(loops.current))
    for current in ([0.2, 0.20002], [0.0, 0.5]):
        loops_png(replace(alike, current=np.array(current)), "name")
    one, two = shown
    assert (len(one.axes), one.get_suptitle()) == (2, "name, 0.2 A")
    assert (len(two.axes), two.get_suptitle()) == (3, "name")
    colours = [{str(line.get_color()) for line in figure.axes[0].lines} for figure in shown]
    assert [len(c) for c in colours] == [1, 2]


def test_one_current_at_several_temperatures_is_coloured_by_temperature(loops, monkeypatch):
    shown: list[Figure] = []
    monkeypatch.setattr("sysid.report.loop_plots.png", shown.append)
    alike = replace(loops.select(np.isfinite(loops.current)), current=np.array([0.2, 0.20002]))
    for temperature in ([15.0, 75.0], [38.0, 41.0]):  # a sweep, and what is meant as one
        loops_png(replace(alike, temperature=np.array(temperature)), "name")
    sweep, one = shown
    assert [figure.get_suptitle() for figure in shown] == ["name, 0.2 A"] * 2
    assert sweep.axes[-1].get_ylabel() == "temperature / °C"
    assert len(one.axes) == 2
    colours = [{str(line.get_color()) for line in figure.axes[0].lines} for figure in shown]
    assert [len(c) for c in colours] == [2, 1]


def test_a_history(loops):
    one = record(0.5)
    ax = plot_history((one, 0.5 * one.force))
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), one.time)
    np.testing.assert_array_equal(ax.lines[1].get_ydata(), 0.5 * one.force)


def test_files_are_pictures_and_the_same_each_time(loops):
    first = loops_png(loops, "name")
    assert first.startswith(b"\x89PNG")
    assert loops_png(loops, "name") == first
    assert worst_png(loops, 0, loops.force[0], "worst").startswith(b"\x89PNG")
    assert history_png(record(0.5), record(0.5).force, "worst").startswith(b"\x89PNG")
