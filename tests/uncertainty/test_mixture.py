"""Half widths of mixtures of t distributions: against draws, and against each alone."""

import numpy as np
import pytest
from scipy.stats import t

from sysid.uncertainty.mixture import half_width

WEIGHT = np.array([0.6, 0.3, 0.1])
SD = np.array([[1.0, 1.0], [2.0, 1.0], [5.0, 1.0]])
FREEDOM = np.array([[5.0, 30.0], [8.0, 30.0], [3.0, 30.0]])


def inside(half: float, column: int, draws: int = 200_000) -> float:
    """Share of draws of the mixture within a half width."""
    rng = np.random.default_rng(1)
    which = rng.choice(len(WEIGHT), draws, p=WEIGHT)
    drawn = SD[which, column] * rng.standard_t(FREEDOM[which, column])
    return float(np.mean(np.abs(drawn) < half))


@pytest.mark.parametrize("level", [0.5, 0.95])
def test_draws_of_the_mixture_lie_within_as_often_as_asked(level):
    """And not as often within a half width one part in twenty narrower, nor wider."""
    x = half_width(WEIGHT, SD, FREEDOM, level)
    assert inside(x[0], 0) == pytest.approx(level, abs=0.002)
    assert inside(0.95 * x[0], 0) < level - 0.004
    assert inside(1.05 * x[0], 0) > level + 0.004


def test_of_equal_ones_it_is_that_of_one():
    assert half_width(WEIGHT, SD, FREEDOM, 0.95)[1] == pytest.approx(t(30.0).ppf(0.975), rel=1e-12)


def test_scales_far_apart_do_not_spoil_it():
    """All of the narrow half lies inside, so of the wide half nine tenths must."""
    x = half_width(np.array([0.5, 0.5]), np.array([[1e-9], [1e4]]), np.full((2, 1), 1e9), 0.95)
    assert x[0] == pytest.approx(1e4 * t(1e9).ppf(0.95), rel=1e-6)
