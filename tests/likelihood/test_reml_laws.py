"""Smooth errors of the valve's laws in Σ: exact algebra, exact slopes, and sizes recovered."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from sysid.likelihood import discrepancy
from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import LAWS, NAMES, Covariance, Parts, Sizes, covariance_parts
from sysid.likelihood.reml import PRIOR, PRIOR_WIDTH, TIMES, fit_sizes, full_rank
from tests.diagnosis.test_lack_of_fit import POINTS, campaign
from tests.likelihood.dense import (
    average_information_is_that_of_the_matrix,
    dense,
    draw,
    jacobian_of,
    restricted_likelihood,
    slopes_are_differences,
)

BASIS = harmonic_basis(POINTS)
SIZES = Sizes(
    gain=0.01,
    offset=4.0,
    delay=3e-4,
    odd=0.02,
    even=0.01,
    scale=0.03,
    width=0.1,
    steepness=0.05,
    growth=0.06,
    thermometer=0.6,
)
EVERY_SIZES = [
    SIZES,
    Sizes(gain=0.01, offset=1.0, delay=1e-4, scale=0.02),
    Sizes(gain=0.0, offset=0.0, delay=0.0, width=0.3, steepness=0.02),
    Sizes(gain=0.0, offset=0.0, delay=0.0, growth=0.1),
    Sizes(gain=0.0, offset=0.0, delay=0.0, thermometer=1.0),
    Sizes(gain=0.0, offset=0.0, delay=0.0),
]


def valve(x, v, a, A, f, i, scale=1.0, width=1.0, steepness=1.0, growth=1.0, warmer=0.0):
    """A step with hysteresis that grows with current, and viscous friction that falls by 3 %/K."""
    moving = v + width * 2e-3 * np.sign(-a)
    return scale * (
        (200 + 1500 * i) * np.tanh(steepness * moving / 0.02)
        + 900 * growth * (1.0 - 0.03 * warmer) * v
    )


def with_laws(currents: tuple[float, ...]) -> Parts:
    """Parts with directions by differences of the valve."""
    loops = campaign(valve, currents, noise=5.0)
    parts = covariance_parts(loops, BASIS)
    directions = []
    for law in LAWS:
        up, down = (
            campaign(lambda *at, by=by, law=law: valve(*at, **{law: by}), currents).force
            for by in (1.01, 0.99)
        )
        directions.append(BASIS.compress((up - down) / 0.02))
    cold, warm = (
        campaign(lambda *at, by=by: valve(*at, warmer=by), currents).force for by in (0.0, 1.0)
    )
    warmth = BASIS.compress(warm - cold)
    return replace(parts, warmth=warmth, laws=np.stack(directions))


@pytest.fixture(scope="module")
def parts() -> Parts:
    """Thirty tests: small enough for differences of the dense matrix."""
    return with_laws((0.0, 0.2, 0.4))


@pytest.fixture(scope="module")
def campaign_parts() -> Parts:
    """Sixty tests at ten of W11's conditions."""
    return with_laws((0.0, 0.08, 0.16, 0.24, 0.32, 0.4))


@pytest.mark.parametrize("sizes", EVERY_SIZES)
def test_solves_root_and_determinant_are_those_of_the_dense_matrix(parts, sizes):
    rng = np.random.default_rng(0)
    a, b = (rng.standard_normal((*parts.force.shape, k)) for k in (2, 3))
    sigma, covariance = dense(parts, sizes), Covariance(parts, sizes)
    expected = a.reshape(-1, 2).T @ np.linalg.solve(sigma, b.reshape(-1, 3))
    np.testing.assert_allclose(covariance.inner(a, b), expected, rtol=1e-6, atol=1e-9)
    white = covariance.whiten(a).T @ covariance.whiten(b)
    np.testing.assert_allclose(white, expected, rtol=1e-6, atol=1e-9)
    solved = covariance.solve(parts.to_modes(b)).modal.reshape(-1, 3)
    np.testing.assert_allclose(
        parts.to_modes(a).reshape(-1, 2).T @ solved, expected, rtol=1e-6, atol=1e-9
    )
    assert covariance.log_determinant == pytest.approx(np.linalg.slogdet(sigma)[1], rel=1e-9)


@pytest.mark.parametrize("quiet", [{"error": 1e-9}, {"silent": True}])
def test_laws_that_nothing_hears_leave_the_rest_of_the_matrix(parts, quiet):
    """A base that leaves nothing at all, and tests without a force (the damper taken out)."""
    bare = replace(parts, laws=parts.laws[:0])
    if "silent" in quiet:
        nothing = np.zeros_like(parts.force)
        bare = replace(bare, force=nothing, rate=nothing)
        without = replace(bare, laws=np.zeros_like(parts.laws))
    else:
        without = replace(parts, error=quiet["error"])
    b = np.random.default_rng(0).standard_normal((*parts.force.shape, 3))
    sizes = replace(SIZES, scale=1e-9, width=1e-9, steepness=1e-9, growth=1e-9)
    np.testing.assert_allclose(
        Covariance(without, sizes).weighted(b), Covariance(bare, sizes).weighted(b), rtol=1e-6
    )


def test_laws_change_the_covariance_by_their_term(parts):
    """The fixture is not trivial: each law moves the determinant by what it should, alone."""
    bare = Sizes(gain=0.0, offset=0.0, delay=0.0)
    plain = Covariance(parts, bare).log_determinant
    for law in LAWS:
        sizes = replace(bare, **{law: 0.05})
        assert Covariance(parts, sizes).log_determinant > plain + 20.0, law


def test_slopes_are_those_of_the_likelihood(parts):
    elsewhere = Sizes(0.02, 6.0, 2e-4, 0.01, 0.02, 0.02, 0.05, 0.1, 0.03, thermometer=0.3)
    slopes_are_differences(parts, SIZES, elsewhere)


@pytest.mark.parametrize("portion", [1, 7, 1000])
def test_portions_change_nothing(parts, portion, monkeypatch):
    """Loops are worked on some at a time: how many, the last portion also, makes no difference."""
    whole = Covariance(parts, SIZES)
    monkeypatch.setattr(discrepancy, "PORTION", portion)
    again = Covariance(parts, SIZES)
    assert again.log_determinant == pytest.approx(whole.log_determinant, rel=1e-12)
    np.testing.assert_allclose(
        again.slopes_of_log_determinant(), whole.slopes_of_log_determinant(), rtol=1e-9
    )


def test_slopes_beside_parts_that_are_absent(parts):
    """What has no size has no columns in V: slopes of the others, and zeros, are as they were."""
    some = replace(SIZES, offset=0.0, steepness=0.0, thermometer=0.0)
    slopes_are_differences(parts, SIZES, some)
    average_information_is_that_of_the_matrix(parts, some)
    slopes = Covariance(parts, some).slopes_of_log_determinant()
    absent = [NAMES.index(name) for name in ("offset", "steepness", "thermometer")]
    assert np.all(slopes[absent] == 0.0)
    assert np.count_nonzero(slopes) == len(NAMES) - 3


def test_average_information_is_that_of_the_dense_matrix(parts):
    average_information_is_that_of_the_matrix(parts, SIZES)


def test_spreads_are_honest(campaign_parts):
    """As without laws: scores of mean −0.2 (ln of a standard deviation is skewed), of scatter 1.

    Of forty draws, 3.3 standard errors of a mean are 0.52 and of a standard deviation 0.37.
    """
    root = np.linalg.cholesky(dense(campaign_parts, SIZES))
    jacobian, truth = jacobian_of(campaign_parts), np.log([getattr(SIZES, n) for n in NAMES])
    scores = []
    for seed in range(40):
        z = np.random.default_rng(seed).standard_normal(root.shape[0])
        found = fit_sizes(campaign_parts, (root @ z).reshape(campaign_parts.force.shape), jacobian)
        sizes = np.log([getattr(found.sizes, n) for n in NAMES])
        scores.append((sizes - truth) / found.spread)
    scores = np.array(scores)
    assert 0.90 <= np.mean(np.abs(scores) < 1.96) <= 0.99
    assert np.all(np.abs(scores.mean(axis=0) + 0.2) < 0.52)
    assert np.all((scores.std(axis=0) > 0.63) & (scores.std(axis=0) < 1.37))


@pytest.mark.parametrize("seed", range(3))
def test_a_smooth_error_of_scale_is_no_gain(campaign_parts, seed):
    """2 %, smooth over conditions, and noise: without laws in Σ it passes for gain."""
    only = Sizes(gain=0.0, offset=0.0, delay=0.0, scale=0.02)
    residual, jacobian = draw(campaign_parts, only, seed), jacobian_of(campaign_parts)
    found = fit_sizes(campaign_parts, residual, jacobian).sizes
    assert found.scale == pytest.approx(only.scale, rel=0.3)
    assert found.gain < 0.005
    lawless = replace(campaign_parts, laws=np.zeros((0, *residual.shape)))
    assert fit_sizes(lawless, residual, jacobian).sizes.gain > 0.005


@pytest.mark.parametrize("gain", [0.0, 0.01])
def test_exact_laws_are_found_exact(campaign_parts, gain):
    """Noise alone, and gain from test to test, which no smooth error explains."""
    sizes = Sizes(gain=gain, offset=0.0, delay=0.0)
    residual = draw(campaign_parts, sizes, 8)
    found = fit_sizes(campaign_parts, residual, jacobian_of(campaign_parts)).sizes
    assert found.scale < 0.003 if gain else found.scale < 0.001
    assert found.width < 0.005
    assert found.steepness < 0.003
    assert found.gain == pytest.approx(gain, rel=0.3, abs=0.001)


def test_parts_of_an_error_are_those_of_the_dense_matrix(parts):
    """E[e_k | r] = Σ_k Σ⁻¹ r; with the noise's, all parts make up the residual."""
    r = draw(parts, SIZES, seed=5)
    solved = np.linalg.solve(dense(parts, SIZES), r.ravel())
    nothing = Sizes(gain=0.0, offset=0.0, delay=0.0)
    noise = np.diag(dense(parts, nothing))
    covariance = Covariance(parts, SIZES)
    for names in (("width",), ("odd", "even"), NAMES):
        only = replace(nothing, **{name: getattr(SIZES, name) for name in names})
        expected = (dense(parts, only) - np.diag(noise)) @ solved
        found = covariance.expected(r, names)
        np.testing.assert_allclose(found.ravel(), expected, atol=1e-7 * np.abs(r).max())
    np.testing.assert_allclose(found.ravel() + noise * solved, r.ravel(), atol=1e-7)


def test_structural_sizes_stay_in_reach_of_what_least_squares_leaves(campaign_parts):
    """A residual that has run off does not drag the sizes with it."""
    r = draw(campaign_parts, replace(SIZES, odd=0.5, width=2.0), seed=1)
    free = fit_sizes(campaign_parts, r, jacobian_of(campaign_parts)).sizes
    bound = replace(campaign_parts, error=0.01)
    held = fit_sizes(bound, r, jacobian_of(bound)).sizes
    assert free.odd > 0.1
    assert held.odd <= TIMES * 0.01 * 1.0001
    for law, directions in zip(LAWS, bound.laws, strict=True):
        reach = np.sqrt(np.sum(directions**2) / np.sum(bound.force**2))
        assert getattr(held, law) * reach <= TIMES * 0.01 * 1.0001


def test_absent_laws_have_no_influence(parts):
    """Sizes of laws that Σ does not have do nothing, are found 0, and keep the prior's spread."""
    lawless = replace(parts, laws=parts.laws[:0])
    residual, jacobian = draw(parts, SIZES, 9), jacobian_of(parts)
    with_sizes, without = (
        Covariance(lawless, sizes)
        for sizes in (SIZES, replace(SIZES, scale=0.0, width=0.0, steepness=0.0, growth=0.0))
    )
    assert with_sizes.log_determinant == without.log_determinant
    np.testing.assert_array_equal(
        with_sizes.inner(jacobian, jacobian), without.inner(jacobian, jacobian)
    )
    found = fit_sizes(lawless, residual, jacobian)
    laws = [NAMES.index(law) for law in LAWS]
    assert [getattr(found.sizes, law) for law in LAWS] == [0.0] * len(LAWS)
    np.testing.assert_allclose(found.spread[laws], PRIOR_WIDTH, rtol=1e-12)
    # laws that move no force are laws that the valve lacks: the same answer
    silent = fit_sizes(replace(parts, laws=np.zeros_like(parts.laws)), residual, jacobian)
    assert silent.log_likelihood == pytest.approx(found.log_likelihood, abs=1e-3)
    for name in NAMES:
        expected = getattr(found.sizes, name)
        assert getattr(silent.sizes, name) == pytest.approx(expected, rel=1e-2), name


def test_parts_of_some_tests(parts):
    kept = np.arange(parts.noise.size) < 10
    some = parts.of(kept)
    assert some.laws.shape == (4, 10, 31)
    np.testing.assert_array_equal(some.warmth, parts.warmth[:10])
    whole = dense(parts, SIZES).reshape(30, 31, 30, 31)[:10, :, :10].reshape(310, 310)
    np.testing.assert_allclose(dense(some, SIZES), whole, rtol=1e-12)
    bare = replace(parts, laws=parts.laws[:0], warmth=np.zeros((0, 0))).of(kept)
    assert bare.laws.shape == (0, 10, 31)
    assert bare.rig == ("gain", "offset", "delay")


def test_parts_of_other_tests_are_refused(parts):
    with pytest.raises(ValueError, match=r"expected \(4, 30, 31\), or no laws"):
        replace(parts, laws=parts.laws[:2])
    with pytest.raises(ValueError, match=r"change with temperature has the shape \(10, 31\)"):
        replace(parts, warmth=parts.warmth[:10])


def probability(parts: Parts, sizes: Sizes, residual: np.ndarray) -> float:
    """Restricted log-likelihood with the prior."""
    usual = np.array([PRIOR[n] * (np.median(parts.scale) if n == "offset" else 1.0) for n in NAMES])
    z = np.log(np.array([getattr(sizes, n) for n in NAMES]) / usual)
    known = restricted_likelihood(Covariance(parts, sizes), residual, full_rank(jacobian_of(parts)))
    return known - 0.5 * float(np.sum((z / PRIOR_WIDTH) ** 2))


@pytest.mark.parametrize("seed", range(3))
def test_where_some_sizes_are_at_their_bound_the_others_are_most_probable(parts, seed):
    """What a bound leaves of a step is no step for the others: it ended up to 34 short."""
    small = replace(parts, error=0.01)
    residual = draw(parts, replace(SIZES, odd=0.05, even=0.05), seed)
    found = fit_sizes(small, residual, jacobian_of(parts), times=1.0).sizes
    assert found.odd == pytest.approx(small.error)
    here = probability(small, found, residual)
    assert probability(small, replace(found, odd=1.01 * found.odd), residual) > here
    reach = [np.linalg.norm(d) / np.linalg.norm(small.force) for d in small.laws]
    bound = {n: small.error / by for n, by in zip(LAWS, reach, strict=True)}
    bound |= {"odd": small.error, "even": small.error}
    free = [n for n in NAMES if getattr(found, n) < 0.999 * bound.get(n, np.inf)]
    assert 3 < len(free) < len(NAMES) - 2, "some laws are at their bound as well"

    def left(z: np.ndarray) -> float:
        moved = {n: getattr(found, n) * np.exp(step) for n, step in zip(free, z, strict=True)}
        return here - probability(small, replace(found, **moved), residual)

    best = minimize(left, np.zeros(len(free)), bounds=[(-0.7, 0.7)] * len(free))
    assert -best.fun < 0.1
