"""Several Σs that may be right: weighted as they should be, many or few, and what they add."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.kernel import LENGTHS, kernel_of
from sysid.likelihood.observed import Observed
from sysid.likelihood.plausible import FAR, NEAR, plausible
from sysid.likelihood.reml import full_rank
from sysid.likelihood.smoothness import STEP, Residual, smoothness_and_sizes
from sysid.uncertainty.spread import mean_spread
from tests.likelihood.dense import draw, restricted_likelihood
from tests.likelihood.on_the_model import COORDINATES, RIG, U, on_the_model
from tests.uncertainty.one_spread import spread_of

WRONG = replace(RIG, scale=0.05, width=0.05, growth=0.05)


@pytest.fixture(scope="module")
def ideal() -> Observed:
    return on_the_model(960_011)


def residual(ideal: Observed, sizes: Sizes, steps: int, seed: int) -> Residual:
    """What errors of such sizes, so many steps smoother than the roughest, leave of the model."""
    a, f, i, t = LENGTHS
    more = STEP**steps
    kernel = kernel_of(ideal.loops, (more * a, more * f, more * i, t))
    parts = replace(ideal.parts, error=np.inf)
    errors = draw(replace(parts, kernel=kernel), sizes, seed)
    force, jacobian = ideal.look(COORDINATES, U)
    there = replace(ideal, parts=parts, measured=ideal.measured - force + errors)
    return Residual(there, there.measured - (ideal.measured - force), jacobian, np.inf)


def about(left: Residual) -> tuple:
    """The most probable lengths, and all that may be right."""
    observed, restricted = smoothness_and_sizes(left.observed, COORDINATES, U, times=np.inf)
    return restricted, plausible(replace(left, observed=observed), restricted)


def test_weights_are_those_of_the_restricted_likelihood(ideal):
    left = residual(ideal, RIG, 0, 1)
    some = about(left)[1]
    assert sum(one.weight for one in some) == pytest.approx(1.0)
    assert len(some) > 1
    solid = full_rank(left.jacobian)
    value = [
        restricted_likelihood(
            Covariance(one.of(left.observed.parts), one.sizes), left.residual, solid
        )
        for one in some
    ]
    logs = np.log([one.weight for one in some])
    np.testing.assert_allclose(logs - logs[0], np.array(value) - value[0], atol=1e-6)
    assert np.ptp(value) < FAR


def test_laws_that_are_right_tell_no_length_and_wrong_ones_do(ideal):
    """Rough errors: none smoother by more than a factor of two comes in, whatever it is worth."""
    right, wrong = (about(residual(ideal, sizes, 0, 1))[1] for sizes in (RIG, WRONG))
    assert len(right) == NEAR + 1
    assert min(one.weight for one in right) > 0.1
    assert max(one.weight for one in wrong) > 0.9
    for some in (right, wrong):
        ratio = [one.lengths[0] / some[0].lengths[0] for one in some]
        assert max(ratio) <= 1.001 * STEP**NEAR
        assert min(ratio) >= 0.999 * STEP**-NEAR


def test_what_is_averaged_is_variance_and_two_widths_give_one_between(ideal):
    """Of one Σ alone the spread is its own; the interval of two is that of the mixture."""
    left = residual(ideal, WRONG, 2, 3)
    some = about(left)[1]
    first, last = (replace(one, weight=0.5, spread=None) for one in (some[0], some[-1]))
    parts, J = left.observed.parts, full_rank(left.jacobian)
    H = np.einsum("lmi,lmj->ij", J, J)
    each = [spread_of(H, J, one.of(parts), one.sizes) for one in (first, last)]
    both = mean_spread(H, J, parts, (first, last))
    mean = 0.5 * (each[0].covariance + each[1].covariance)
    np.testing.assert_allclose(both.covariance, mean, rtol=1e-12)
    apart = [np.diagonal(e.covariance) for e in each]
    widest = np.argmax(np.abs(np.log(apart[0] / apart[1])))
    assert both.quantile[widest] > each[0].quantile[widest]
    half = [e.quantile * np.sqrt(d) for e, d in zip(each, apart, strict=True)]
    mixed = both.quantile * np.sqrt(np.diagonal(mean))
    assert np.all(mixed <= np.maximum(*half) * (1 + 1e-9))
    assert np.all(mixed >= np.minimum(*half) * (1 - 1e-9))
    alone = mean_spread(H, J, parts, (replace(first, weight=1.0),))
    np.testing.assert_allclose(alone.covariance, each[0].covariance, rtol=1e-12)
