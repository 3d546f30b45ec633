"""A damper of a fleet needs the evidence that it would need alone."""

import numpy as np
import pytest

from sysid.fleet.evidence import basins, candidates, evidence
from sysid.identification.multistart import _basins, _nothing_more_to_find


def table(seed, dampers=60, starts=24):
    """Costs of few minima, some starts not converged, some dampers with eight starts only."""
    rng = np.random.default_rng(seed)
    cost = rng.choice([1.0, 1.0004, 1.3, 1.31, 4.0], (dampers, starts), p=[0.5, 0.2, 0.1, 0.1, 0.1])
    cost[rng.random(cost.shape) < 0.05] = np.inf
    cost[: dampers // 2, 8:] = np.nan
    converged = (rng.random(cost.shape) < 0.9) & np.isfinite(cost)
    converged[3] = False
    return cost, converged


@pytest.mark.parametrize("seed", range(3))
def test_the_rule_is_that_of_single_fits(seed):
    cost, converged = table(seed)
    found = evidence(cost, converged)
    for d in range(len(cost)):
        made = ~np.isnan(cost[d])
        single = _basins(cost[d][made], converged[d][made])
        assert basins(cost[d], converged[d]) == single
        assert (found.basins[d], found.hits[d]) == (len(single), single[0].hits)
        assert found.starts[d] == made.sum()
        assert found.enough[d] == _nothing_more_to_find(single, int(made.sum()))


def test_three_starts_are_enough_where_all_agree_and_only_there():
    ends = np.array([[1.0, 1.0, 1.0], [1.0, 1.0, 1.5]])
    assert evidence(ends, np.ones_like(ends, dtype=bool)).enough.tolist() == [True, False]


def test_minima_that_may_change_order_on_all_data_are_candidates():
    assert candidates(np.array([1.3, 1.02, np.inf, 1.0, 1.0001, np.nan])).tolist() == [3, 1]
