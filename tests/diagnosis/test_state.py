"""A fit and its covariance belong to each other, wherever the turns between them began."""

from dataclasses import replace

import pytest

from sysid.diagnosis.state import settle
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
