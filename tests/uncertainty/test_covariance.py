"""Intervals: exact where theory is exact, honest where the data say nothing."""

import numpy as np
import pytest
from scipy import stats

from sysid.identification.fit import fit_loops
from sysid.models.generalized import ASYMMETRIC, LOW_SYMMETRIC
from sysid.uncertainty.covariance import cluster_jackknife, sandwich
from tests.identification.campaigns import FIVE_CURRENTS, LOW_DESIGN, virtual_loops


def linear_grams(X, y, cluster, beta):
    r = X @ beta - y
    full = np.concatenate([X, r[:, None]], axis=1)
    return np.stack([full[cluster == c].T @ full[cluster == c] for c in np.unique(cluster)])


def test_leaving_out_clusters_is_exact_for_linear_models():
    rng = np.random.default_rng(0)
    cluster = np.repeat(np.arange(12), 10)
    X = rng.standard_normal((120, 3))
    shared = 3.0 * rng.standard_normal((12, 3))[cluster]
    y = X @ np.array([1.0, -2.0, 0.5]) + np.sum(shared * X, axis=1) + rng.standard_normal(120)
    beta = np.linalg.lstsq(X, y, rcond=None)[0]
    covariance, count = cluster_jackknife(
        linear_grams(X, y, cluster, beta), np.arange(12), np.full(12, 10)
    )
    left_out = np.stack(
        [np.linalg.lstsq(X[cluster != c], y[cluster != c], rcond=None)[0] for c in range(12)]
    )
    expected = 11 / 12 * (left_out - left_out.mean(axis=0)).T @ (left_out - left_out.mean(axis=0))
    assert count == 12
    np.testing.assert_allclose(covariance, expected, rtol=1e-8)


def coverage(make_interval, campaigns=400):
    rng = np.random.default_rng(1)
    cluster = np.repeat(np.arange(20), 15)
    hits = 0
    for _ in range(campaigns):
        X = np.stack([np.ones(300), rng.standard_normal(20)[cluster]], axis=1)
        y = X @ np.array([1.0, 2.0]) + rng.standard_normal(20)[cluster] + rng.standard_normal(300)
        beta = np.linalg.lstsq(X, y, rcond=None)[0]
        half = make_interval(X, y, cluster, beta)
        hits += abs(beta[1] - 2.0) < half
    return hits / campaigns


def clustered(X, y, cluster, beta):
    covariance, count = cluster_jackknife(
        linear_grams(X, y, cluster, beta), np.arange(20), np.full(20, 15)
    )
    return stats.t.ppf(0.975, count - 1) * np.sqrt(covariance[1, 1])


def test_correlated_residuals_are_covered_where_least_squares_fails():
    """A correct, a too narrow and a too wide interval, so that the test can tell them apart."""

    def independent(X, y, cluster, beta):
        r = y - X @ beta
        return 1.96 * np.sqrt(np.linalg.inv(X.T @ X)[1, 1] * (r @ r) / 298)

    low, high = stats.binom.ppf([0.0005, 0.9995], 400, 0.95) / 400
    assert low <= coverage(clustered) <= min(high + 0.01, 1.0)
    assert coverage(independent) < low
    assert coverage(lambda *z: 3 * clustered(*z)) > high


def unequal_noise(seed):
    """Parameters of quiet tests and of loud ones, a thousand times as loud."""
    rng = np.random.default_rng([2, seed])
    cluster = np.repeat(np.arange(24), 30)
    quiet = (cluster < 8)[:, None]
    rows = rng.standard_normal((720, 2))
    X = np.concatenate([rows * quiet, rows * ~quiet], axis=1)
    sd = np.where(quiet[:, 0], 1e-3, 1.0)
    return X, X @ np.array([1.0, 2.0, 3.0, 4.0]) + sd * rng.standard_normal(720), cluster


def test_quiet_tests_and_loud_ones_are_covered_alike():
    """Right, too narrow, too wide, and with one noise for all too wide for the quiet ones."""

    def hits(factor=1.0, *, pooled=False):
        inside = np.zeros(4)
        for seed in range(300):
            X, y, cluster = unequal_noise(seed)
            beta = np.linalg.lstsq(X, y, rcond=None)[0]
            grams = linear_grams(X, y, cluster, beta)
            covariance, _ = cluster_jackknife(grams, np.arange(24), np.full(24, 30))
            if pooled:
                H = grams.sum(axis=0)
                covariance = H[-1, -1] / 716 * np.linalg.inv(H[:-1, :-1])
            half = factor * stats.t.ppf(0.975, 23) * np.sqrt(np.diagonal(covariance))
            inside += np.abs(beta - np.array([1.0, 2.0, 3.0, 4.0])) < half
        return inside.reshape(2, 2).sum(axis=1)

    low, high = stats.binom.ppf([0.0005, 0.9995], 600, 0.95)
    assert (hits() >= low).all()
    assert (hits() <= high).all()
    assert hits(pooled=True)[0] == 600
    assert (hits(0.5) < low).all()
    assert (hits(2.0) > high).all()


def test_with_one_test_the_noise_is_its_own():
    """Least squares as in any book."""
    X, y, _ = unequal_noise(0)
    X, y = X[240:, 2:], y[240:]
    beta = np.linalg.lstsq(X, y, rcond=None)[0]
    grams = linear_grams(X, y, np.zeros(480), beta)
    covariance, count = cluster_jackknife(grams, np.array([0]), np.array([480]))
    r = y - X @ beta
    assert count == 1
    np.testing.assert_allclose(covariance, r @ r / 478 * np.linalg.inv(X.T @ X), rtol=1e-10)


def test_a_direction_without_data_is_open_not_sharp():
    """Three currents fix two values of the gain, and three parameters make them."""
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, (0.0, 0.2, 0.4), noise=0.01)
    estimates = sandwich(fit_loops(loops, variant="symmetric"))
    by_symbol = {p.symbol: p for p in estimates.parameters}
    for symbol in ("I_0", "a_2", "k_2", "I_1", "a_3", "k_3"):
        assert not by_symbol[symbol].identified, symbol
    for symbol in ("F_0", "a_1", "k_1c"):
        assert by_symbol[symbol].identified, symbol
    words = " ".join(estimates.undetermined)
    assert "I_0" in words
    assert "k_3" in words


def test_held_parameters_carry_no_uncertainty_and_followers_that_of_their_leader():
    loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.01)
    estimates = sandwich(fit_loops(loops, variant="symmetric"))
    by_symbol = {p.symbol: p for p in estimates.parameters}
    assert by_symbol["k_5"].sd == 0.0
    assert by_symbol["k_1e"].sd == by_symbol["k_1c"].sd > 0.0
    assert estimates.covariance.shape == (13, 13)
    assert "k_1e" not in estimates.symbols


def test_truth_lies_inside_most_intervals():
    """Of eight campaigns, not of one alone; intervals half as wide would miss it too often."""
    inside = {1.0: [], 0.5: []}
    for seed in range(8):
        loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=0.01, seed=seed)
        for p in sandwich(fit_loops(loops, variant="symmetric")).parameters:
            if p.sd > 0.0:
                off = abs(p.value - LOW_SYMMETRIC[p.symbol])
                for factor, hits in inside.items():
                    hits.append(off <= factor * 0.5 * (p.high - p.low))
    assert np.mean(inside[1.0]) >= 0.9
    assert np.mean(inside[0.5]) < 0.85


def test_ratio_that_remains_known_is_named():
    """Only fast loops: a_0 and k_0 cannot be told apart, k_0/a_0 can."""
    table = {**ASYMMETRIC, "a_0": 1e5, "k_0": 1.5e4}
    design = [(0.0125, f) for f in (2.0, 2.5, 3.0)] + [(0.025, f) for f in (1.0, 1.25, 1.5)]
    loops = virtual_loops(table, design, (0.0, 0.1, 0.2, 0.3), noise=0.02)
    estimates = sandwich(fit_loops(loops))
    sentence = next(s for s in estimates.undetermined if "a_0" in s and "k_0" in s)
    assert "run off together" in sentence
    assert "k_0/a_0 = 0.15" in sentence or "a_0/k_0 = 6.6" in sentence


@pytest.mark.parametrize("parameter", ["F_0", "a_1"])
def test_more_noise_gives_wider_intervals(parameter):
    widths = []
    for noise in (0.01, 0.04):
        loops = virtual_loops(LOW_SYMMETRIC, LOW_DESIGN, FIVE_CURRENTS, noise=noise)
        estimates = sandwich(fit_loops(loops, variant="symmetric"))
        widths.append(next(p.sd for p in estimates.parameters if p.symbol == parameter))
    assert widths[1] == pytest.approx(4 * widths[0], rel=0.5)


@pytest.mark.parametrize("offset", [0.0, 1e-12, 1e-8, 1e-4])
def test_what_one_cluster_alone_sees_has_independent_noise_however_well_the_fit_converged(offset):
    rng = np.random.default_rng(0)
    cluster = np.repeat(np.arange(10), 60)
    X = rng.standard_normal((600, 3))
    X[cluster != 0, 2] = 0.0
    y = X @ np.array([1.0, 2.0, 3.0]) + 0.05 * rng.standard_normal(600)
    beta = np.linalg.lstsq(X, y, rcond=None)[0] + np.array([0.0, 0.0, offset])
    covariance, _ = cluster_jackknife(
        linear_grams(X, y, cluster, beta), np.arange(10), np.full(10, 60)
    )
    independent = 0.05 * np.sqrt(np.diagonal(np.linalg.inv(X.T @ X)))
    assert np.sqrt(covariance[2, 2]) == pytest.approx(independent[2], rel=0.15)
