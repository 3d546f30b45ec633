"""Least squares with errors of unknown size: likelihoods and distances of models fitted so."""

import numpy as np
import pytest

from sysid.diagnosis.plain import INDEPENDENT, plain_distance, plainly_fitted, unweighted


def test_a_distance_is_what_the_likelihood_gains(evidence, base_state, spring_state):
    """Of two nested models, by Pythagoras: |Δ|² = what the one leaves less what the other does."""
    campaign = unweighted(evidence)
    before = plainly_fitted(campaign, base_state.coordinates, base_state.u)
    one = plainly_fitted(campaign, spring_state.coordinates, spring_state.u)
    numbers = INDEPENDENT * campaign.tests
    gained = one.likelihood - before.likelihood
    assert gained > 10.0
    of_likelihood = np.sqrt(numbers * -np.expm1(-2.0 * gained / numbers))
    assert plain_distance(before, one, before) == pytest.approx(of_likelihood, rel=0.02)
    assert plain_distance(before, one, one) == 0.0
