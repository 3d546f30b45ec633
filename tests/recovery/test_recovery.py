"""Fast slices of the benchmarks: known dampers are found again from their loops alone."""

import numpy as np
import pytest
from best_known import NEAR, polish_from_truth
from campaigns import NOISE, TABLES, draw_campaign, random_conditions, table_one
from paper_symbols import PaperFit, jacobian

from sysid.identification.fit import fit_loops
from sysid.identification.problem import loop_problem
from sysid.trials.proportions import Share, bootstrap
from sysid.uncertainty.covariance import sandwich


def test_table_one_has_the_22_slow_conditions_at_5_currents():
    amplitude, frequency, current = table_one()
    assert amplitude.size == 110
    assert len({(a, f) for a, f in zip(amplitude, frequency, strict=True)}) == 22
    assert 2 * np.pi * (amplitude * frequency).max() <= 0.4
    assert set(current) == {0.0, 0.1, 0.2, 0.3, 0.4}


def test_truth_is_jittered_and_keeps_its_symmetry():
    for seed in range(20):
        campaign = draw_campaign(seed)
        table = TABLES[campaign.table]
        ratio = np.array([campaign.truth[s] / v for s, v in table.items() if v])
        assert np.all(np.abs(ratio - 1) <= 0.3)
        assert np.ptp(ratio) > 0.2
        if campaign.symmetric:
            assert campaign.truth["k_1e"] == campaign.truth["k_1c"]
            assert campaign.truth["k_5"] == campaign.truth["k_6"] == 0.0


@pytest.mark.parametrize("table", TABLES)
def test_fit_without_start_ends_in_the_global_optimum(table):
    campaign = draw_campaign(77, table=table)
    fit = fit_loops(campaign.loops)
    assert fit.result.name == "converged"
    assert fit.cost <= polish_from_truth(campaign) * (1 + NEAR)
    # white noise of 1 % of each test's RMS is all that is left
    relative = np.array([t.rmse for t in fit.tests]) / np.sqrt(
        np.mean(campaign.loops.force**2, axis=1)
    )
    assert np.median(relative) == pytest.approx(NOISE, rel=0.05)
    assert fit.cost == pytest.approx(NOISE**2 * np.sum(campaign.loops.force**2), rel=0.05)


def test_intervals_contain_most_of_the_truth():
    inside = []
    for seed in (3, 5, 7):
        campaign = draw_campaign(seed, table="low")
        estimates = sandwich(fit_loops(campaign.loops, variant="symmetric"))
        assert {"F_0", "a_1", "k_4"} <= {p.symbol for p in estimates.parameters if p.identified}
        inside += [
            p.low <= campaign.truth[p.symbol] <= p.high
            for p in estimates.parameters
            if p.symbol in estimates.symbols and p.identified
        ]
    assert np.mean(inside) > 0.8


def test_peers_see_the_same_cost_as_the_fit():
    """A peer that minimised something else would make every ratio of times meaningless."""
    campaign = draw_campaign(11, table="asymmetric")
    fit = fit_loops(campaign.loops)
    paper = PaperFit(campaign)
    theta = np.array([float(getattr(fit.valve, s)) for s in campaign.truth])
    assert paper.cost(theta) * np.sum(campaign.loops.force**2) == pytest.approx(fit.cost, rel=1e-9)
    derivative = jacobian(campaign)(theta)
    for k, step in enumerate(1e-6 * np.abs(theta)):
        shifted = [theta + sign * step * np.eye(theta.size)[k] for sign in (1, -1)]
        difference = (paper.residuals(shifted[0]) - paper.residuals(shifted[1])) / (2 * step)
        scale = np.abs(difference).max()
        assert np.abs(derivative[:, k] - difference).max() < 1e-6 * scale


def test_large_campaigns_have_as_many_tests_as_asked_for_below_the_fastest_speed():
    conditions = random_conditions(37, np.random.default_rng(0))
    assert [z.size for z in conditions] == [37, 37, 37]
    assert 2 * np.pi * (conditions[0] * conditions[1]).max() <= 0.4
    assert loop_problem(draw_campaign(0, conditions=conditions).loops).tests == 37


def test_wilson_interval_and_bootstrap():
    low, high = Share(10, 10).interval
    assert (low, high) == (pytest.approx(0.7225, abs=1e-4), pytest.approx(1.0))
    values = np.arange(100.0)
    mean, below, above = bootstrap(lambda k: float(values[k].mean()), 100)
    assert mean == 49.5
    assert above - below == pytest.approx(2 * 1.96 * values.std() / 10, rel=0.1)
