"""A fit and its covariance belong to each other, wherever the turns between them began."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.state import BORNE_OUT, State, gained, settle
from sysid.likelihood.discrepancy import LAWS, Covariance
from sysid.likelihood.settling import UNSETTLED, _left


@pytest.mark.parametrize("wrong", [1.0, 30.0])
def test_the_likelihood_is_that_of_parameters_fitted_under_its_own_covariance(
    evidence, base_state, wrong
):
    """One turn under a Σ of errors so large that parameters hardly count: they must be fitted anew.

    Otherwise what an effect gains would hold how far the turns had come, which can be thousands.
    """
    sizes = base_state.sizes
    loose = replace(sizes, odd=0.01 * wrong, **dict.fromkeys(LAWS, 0.01 * wrong))
    start = base_state.u + 0.05
    found = settle(
        evidence, base_state.coordinates, start, Covariance(evidence.parts, loose), passes=1
    )
    assert _left(found.gls, found.covariance) < UNSETTLED
    assert found.likelihood == pytest.approx(base_state.likelihood, abs=3.0)


def moved(state: State, likelihood: float, restricted: float) -> State:
    """The same with other likelihoods."""
    more = replace(state.restricted, log_likelihood=state.restricted.log_likelihood + restricted)
    return replace(state, likelihood=state.likelihood + likelihood, restricted=more)


@pytest.mark.parametrize(
    ("likelihood", "restricted", "counts"),
    [(50.0, 48.0, 50.0), (14.0, 82.0, 14.0), (54.6, -10.5, -10.5), (50.0, 10.0, 10.0)],
)
def test_a_gain_counts_where_the_restricted_likelihood_bears_it_out(
    base_state, likelihood, restricted, counts
):
    """The third is a backlash that was no cause, in tests of one current with three others."""
    after = moved(base_state, likelihood, restricted)
    assert gained(after, base_state, 500.0) == pytest.approx(counts, abs=1e-6)


def test_both_likelihoods_gain_alike_from_an_effect_that_is_there(base_state, spring_state):
    plain = spring_state.likelihood - base_state.likelihood
    assert plain > 30.0
    bare = spring_state.restricted.log_likelihood - base_state.restricted.log_likelihood
    assert bare > 1.5 * BORNE_OUT * plain
    assert gained(spring_state, base_state, 500.0) == plain


@pytest.mark.parametrize("scale", [1 / 30, 30.0])
def test_a_gain_does_not_know_the_unit_of_force(evidence, base_state, spring_state, scale):
    """Each parameter more raises the restricted likelihood by ln(scale) when all forces grow."""
    n = spring_state.u.size - base_state.u.size
    assert n == 1
    rms = evidence.size.force
    for borne_out in (0.0, -100.0):
        at_home = moved(spring_state, 0.0, borne_out)
        grown = moved(spring_state, 0.0, borne_out + n * np.log(scale))
        found = gained(grown, base_state, scale * rms)
        assert found == pytest.approx(gained(at_home, base_state, rms), abs=1e-9)
