"""Rows of the map of errors: in an order that shows what they go with, and told apart."""

from dataclasses import replace

import numpy as np

from sysid.diagnosis.lack_of_fit import lack_of_fit
from sysid.report.lack_of_fit_plot import plot_residual_map
from tests.data.shipped import shipped_loops


def rows(loops) -> tuple[list[str], np.ndarray]:
    """Their names, and what is drawn in them."""
    found = lack_of_fit(loops, 0.9 * loops.force)
    ax = plot_residual_map(loops, found)
    image = np.asarray(ax.images[0].get_array())
    return [label.get_text() for label in ax.get_yticklabels()], image


def test_tests_of_a_sweep_stand_from_cold_to_warm_in_each_excitation():
    loops = shipped_loops("virtual-sweep")
    names, image = rows(loops)
    assert len(set(names)) == len(names) == 168
    parts = [name.split("  ") for name in names]
    warm = np.array([float(part[3].removesuffix(" °C")) for part in parts]).reshape(24, 7)
    np.testing.assert_allclose(warm, np.tile(np.arange(15.0, 76.0, 10.0), (24, 1)), atol=2.0)
    assert (np.diff([float(part[0].removesuffix(" A")) for part in parts]) >= 0.0).all()
    assert names[-1].startswith("1 A  10.1 mm  8 Hz"), "the fastest, warmest, with most current"
    force = loops.force[loops.ids.index("10mm_8Hz_1A_75C")]
    np.testing.assert_allclose(image[-1], 10.0 * force / np.abs(force).max(), atol=1e-9)


def test_in_a_matrix_temperature_is_not_told():
    loops = shipped_loops("virtual-w11-low")
    names, _ = rows(loops)
    assert not any("°C" in name for name in names)
    scattered = replace(loops, temperature=40.0 + 10.0 * np.sin(np.arange(len(loops.ids))))
    assert rows(scattered)[0] == names


def test_tests_of_unknown_current_and_temperature_are_drawn():
    loops = shipped_loops("virtual-w11-low")
    unknown = np.full(len(loops.ids), np.nan)
    names, image = rows(replace(loops, current=unknown, temperature=unknown))
    assert len(names) == len(image) == len(loops.ids)
