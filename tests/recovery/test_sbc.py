"""The rank test finds posteriors that are too wide, too narrow or beside the truth alone."""

import numpy as np
import pytest
from ranks import band, p_value, rank

CAMPAIGNS, DRAWS = 200, 99


def ranks_of(seed: int, *, width: float = 1.0, beside: float = 0.0) -> np.ndarray:
    """Of a normal mean with a normal prior, whose posterior is known; draws made wider or moved."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(CAMPAIGNS):
        truth = rng.standard_normal()
        measured = truth + 0.5 * rng.standard_normal()
        # prior N(0, 1), noise 0.5: the posterior is normal with variance 1/5
        sd = np.sqrt(0.2)
        draws = 0.8 * measured + sd * (beside + width * rng.standard_normal(DRAWS))
        found += rank(draws[:, None], np.array([truth]))
    return np.array(found)


def test_right_posteriors_are_called_wrong_as_often_as_the_level_says():
    p = np.array([p_value(ranks_of(seed), DRAWS) for seed in range(200)])
    assert np.mean(p < 0.05) == pytest.approx(0.05, abs=0.035)
    assert np.mean(p < 0.5) == pytest.approx(0.5, abs=0.12)


@pytest.mark.parametrize(
    "change", [{"width": 1.4}, {"width": 0.7}, {"beside": 0.4}], ids=["wide", "narrow", "beside"]
)
def test_wrong_posteriors_are_found(change):
    p = np.array([p_value(ranks_of(seed, **change), DRAWS) for seed in range(20)])
    assert np.mean(p < 0.05) >= 0.9


def test_the_band_holds_the_whole_distribution_function():
    z, low, high = band(CAMPAIGNS, DRAWS)
    inside = 0
    for seed in range(200):
        ranks = ranks_of(1000 + seed)
        below = np.mean(ranks[:, None] < np.round(z * (DRAWS + 1.0)), axis=0)
        inside += bool(np.all((below >= low) & (below <= high)))
    assert inside / 200 == pytest.approx(0.95, abs=0.04)
    middle = np.argmin(np.abs(z - 0.5))
    # wider than a band for one point, 1.96 √(¼/N)
    assert 0.5 * (high - low)[middle] > 1.96 * np.sqrt(0.25 / CAMPAIGNS)
