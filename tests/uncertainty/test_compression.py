"""Reweighting: a likelihood that was compressed rightly, too wide, too narrow, and off."""

import numpy as np
import pytest

from sysid.uncertainty.compression import compression_error

DRAWS = np.random.default_rng(0).standard_normal((4000, 3)) * np.array([1.0, 1e3, 1e-4])
Z = DRAWS / np.array([1.0, 1e3, 1e-4])


def test_the_same_likelihood_changes_nothing():
    found = compression_error(DRAWS, np.full(len(DRAWS), -7.3))
    assert found.mean == pytest.approx(0.0, abs=1e-12)
    assert found.sd == pytest.approx(0.0, abs=1e-12)
    assert found.draws == pytest.approx(len(DRAWS))
    assert found.small


@pytest.mark.parametrize("width", [0.95, 1.05], ids=["too wide", "too narrow"])
def test_another_width_is_found(width):
    """Draws are too wide, or too narrow, in the first parameter by 5 %."""
    ratio = 0.5 * Z[:, 0] ** 2 * (1.0 - 1.0 / width**2)
    found = compression_error(DRAWS, ratio)
    assert found.sd == pytest.approx(0.05, abs=0.01)
    assert not found.small


def test_another_place_is_found_in_standard_deviations():
    found = compression_error(DRAWS, 0.1 * Z[:, 1])
    assert found.mean == pytest.approx(0.1, abs=0.02)
    assert not found.small
