"""A slice of the study of wrongly recorded tests."""

import numpy as np
import pytest
from odd_tests import CHANCE, SLIPS, odd_in

from sysid.data.loops import Loops
from sysid.rig.trial_campaign import make_trial
from sysid.trials.regimes import plan
from sysid.trials.trial_id import first_seed


@pytest.fixture(scope="module")
def loops() -> Loops:
    """The first campaign of the blind trials that hides nothing."""
    (spec,) = plan("none", 1, first_seed("none"))
    return make_trial(spec.seed, spec.hidden, None, spec.design).loops


def test_nobody_is_odd_where_nothing_is_wrong(loops: Loops) -> None:
    assert odd_in(loops) is None


@pytest.mark.parametrize("slip", SLIPS, ids=lambda slip: slip.name)
def test_a_slip_is_found_in_the_test_that_has_it(slip, loops: Loops) -> None:
    random = np.random.default_rng([0, CHANCE])
    k = len(loops.ids) // 2
    found = odd_in(slip.spoil(loops, k, random))
    assert found is not None
    assert found.ids == (loops.ids[k],)
    assert slip.clause in found.tests[0].looks[0]
