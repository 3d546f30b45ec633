"""A whole posterior against theory, its file, its intervals and how it goes on."""

import dataclasses

import numpy as np
import pytest

from sysid.cards.build import posterior_of
from sysid.errors import CardError
from sysid.uncertainty.chain import BLOCK
from sysid.uncertainty.compression import CompressionError
from sysid.uncertainty.covariance import estimate_of
from sysid.uncertainty.jump import jump_fitted
from sysid.uncertainty.posterior import interval
from sysid.uncertainty.posterior_file import posterior_bytes, read_posterior, thinned
from sysid.uncertainty.profiles import profiles
from sysid.uncertainty.sample import open_beside, sample_posterior
from sysid.uncertainty.target import exact_log_likelihood, log_prior
from tests.uncertainty.conftest import PASSIVE

ENDS = (0.025, 0.975)


def test_it_converges_and_says_how(drawn):
    posterior, _ = drawn
    assert posterior.message == "converged"
    assert posterior.trusted
    assert posterior.convergence.rhat.max() < 1.01
    assert posterior.convergence.bulk.min() > 400
    assert posterior.convergence.tail.min() > 400
    assert posterior.convergence.steps > 50 * posterior.convergence.tau.max()
    assert posterior.compression.mean < 0.02
    assert posterior.compression.sd < 0.02
    assert len(posterior.prior) == len(posterior.symbols) == 7
    assert posterior.draws.shape[0] == 4


def test_where_all_is_nearly_linear_it_is_the_normal_density_of_least_squares(drawn, made):
    posterior, _ = drawn
    u = posterior.coordinates.reshape(-1, 7)
    known = np.sqrt(np.diagonal(np.linalg.inv(made.errors.information)))
    nearly_linear = known < 0.05
    assert nearly_linear.sum() >= 4
    sd = u.std(axis=0)[nearly_linear]
    assert sd / known[nearly_linear] == pytest.approx(np.ones(sd.size), abs=0.08)
    away = (u.mean(axis=0) - made.errors.u)[nearly_linear]
    assert np.abs(away / sd).max() < 0.3


def test_it_is_the_density_that_weighted_draws_of_another_one_have(drawn, made):
    """Importance sampling knows no walkers, no reduction and no rule for stopping."""
    posterior, _ = drawn
    flat = posterior.coordinates.reshape(-1, 7)
    other = jump_fitted(flat)
    u = other.draw(20_000, np.random.default_rng(0))
    density = exact_log_likelihood(made.prior, made.errors, u) + log_prior(made.prior, u)
    weight = np.exp(density - other.log_density(u) - np.max(density - other.log_density(u)))
    assert weight.sum() ** 2 / np.sum(weight**2) > 5000.0

    def apart(draws: np.ndarray) -> float:
        """Largest difference of a median or an end, in standard deviations."""
        order = np.argsort(u, axis=0)
        share = np.cumsum(weight[order], axis=0) / weight.sum()
        ends = [
            [np.interp(q, share[:, k], u[order[:, k], k]) for k in range(7)] for q in (*ENDS, 0.5)
        ]
        found = np.quantile(draws, (*ENDS, 0.5), axis=0)
        return float(np.max(np.abs(found - ends) / flat.std(axis=0)))

    middle = np.median(flat, axis=0)
    assert apart(flat) < 0.12
    assert apart(middle + 0.9 * (flat - middle)) > 0.15
    assert apart(middle + 1.1 * (flat - middle)) > 0.15


def test_the_truth_is_not_far_out(drawn):
    posterior, _ = drawn
    truth = np.array([PASSIVE[s] for s in posterior.symbols])
    away = (truth - posterior.flat.mean(axis=0)) / posterior.flat.std(axis=0)
    assert np.abs(away).max() < 3.5
    for p in posterior.parameters:
        assert p.low < p.value < p.high
        assert p.identified


def test_a_budget_that_is_spent_at_once_ends_warm_up_and_chain_at_their_first_blocks(drawn, made):
    posterior, _ = drawn
    hasty = sample_posterior(made.fit, made.loops, likelihood="independent", budget=0.0)
    steps = hasty.evaluations / (4 * posterior.walkers)
    assert hasty.message == "not converged: the time budget was spent"
    assert not hasty.trusted
    assert steps == 3 * BLOCK  # two stages of the warm-up, and the chain
    assert hasty.convergence.steps == BLOCK


def test_a_chain_goes_on_from_its_folder_to_the_same_end(drawn, made, tmp_path):
    posterior, folder = drawn
    kept = tmp_path / "parts"
    kept.mkdir()
    for name in ("setup.h5", "000000.h5", "000001.h5"):
        (kept / name).write_bytes((folder / name).read_bytes())
    again = sample_posterior(made.fit, made.loops, likelihood="independent", folder=kept)
    assert np.array_equal(again.draws, posterior.draws)
    assert np.array_equal(again.log_probability, posterior.log_probability)
    assert again.evaluations == posterior.evaluations


def test_a_chain_of_another_prior_does_not_go_on(drawn, made, tmp_path):
    kept = tmp_path / "parts"
    kept.mkdir()
    for name in ("setup.h5", "000000.h5"):
        (kept / name).write_bytes((drawn[1] / name).read_bytes())
    other = dataclasses.replace(made.prior, wide=2.0)
    hasty = sample_posterior(
        made.fit, made.loops, likelihood="independent", prior=other, budget=0.0, folder=kept
    )
    assert hasty.prior != drawn[0].prior
    first = drawn[0].draws[:, : hasty.draws.shape[1]]
    assert not np.array_equal(hasty.draws, first)


def test_what_runs_off_is_not_identified_however_narrow_its_draws_are(made):
    """Without end, or down to a bound that the draws end short of: both by the prior."""
    found = {p.symbol: p for p in profiles(made.fit, made.errors, ["a_0", "a_1", "k_0"])}
    found["a_0"] = dataclasses.replace(found["a_0"], high=np.inf, closed=(True, False))
    found["a_1"] = dataclasses.replace(found["a_1"], low=0.0, closed=(False, True))
    hasty = sample_posterior(
        made.fit, made.loops, likelihood="independent", profiles=[*found.values()], budget=0.0
    )
    assert hasty.open == ("a_0", "a_1")
    assert [p.symbol for p in hasty.parameters if not p.identified] == ["a_0", "a_1"]


def test_what_the_draws_themselves_leave_open_down_to_its_bound_is_ended_by_it(made):
    (one,) = profiles(made.fit, made.errors, ["a_1"])
    one = dataclasses.replace(one, low=0.0, closed=(False, True))
    e = estimate_of(one.declared, 1.0, 0.2, 1.96)
    assert open_beside([one], [e]) == ("a_1",)
    assert open_beside([one], [dataclasses.replace(e, low=0.0)]) == ()


def test_the_file_holds_all_of_it(drawn, tmp_path):
    posterior = dataclasses.replace(thinned(drawn[0]), open=("a_0",))
    (tmp_path / "posterior.h5").write_bytes(posterior_bytes(posterior))
    back = read_posterior(tmp_path / "posterior.h5")
    for field in dataclasses.fields(posterior):
        one, other = getattr(posterior, field.name), getattr(back, field.name)
        if field.name == "convergence":
            assert np.array_equal(one.bulk, other.bulk)
            assert one.reached == other.reached
        else:
            assert np.array_equal(one, other) if isinstance(one, np.ndarray) else one == other
    assert posterior_bytes(back) == posterior_bytes(posterior)
    (tmp_path / "posterior.h5").write_bytes(b"half")
    with pytest.raises(CardError, match="cannot be read as a posterior"):
        read_posterior(tmp_path / "posterior.h5")


def test_thinning_keeps_the_distribution(drawn):
    slow = dataclasses.replace(drawn[0].convergence, tau=np.full(7, 8.0))
    whole = dataclasses.replace(drawn[0], convergence=slow)
    some = thinned(whole)
    assert some.draws.shape[1] == pytest.approx(whole.draws.shape[1] / 4, rel=0.02)
    sd = whole.flat.std(axis=0)
    assert np.abs((some.flat.mean(axis=0) - whole.flat.mean(axis=0)) / sd).max() < 0.05
    assert some.by_walker.shape[2:] == whole.by_walker.shape[2:]


@pytest.mark.parametrize(
    ("factor", "least", "most"),
    [(1.0, 0.93, 0.97), (2.0, 0.99, 1.0), (0.5, 0.0, 0.75)],
    ids=["right", "too wide", "too narrow"],
)
def test_intervals_cover_as_often_as_they_say_if_the_draws_are_right(factor, least, most):
    rng = np.random.default_rng(0)
    hits = 0
    for _ in range(1000):
        truth = rng.standard_normal()
        measured = truth + 0.5 * rng.standard_normal()
        # prior N(0, 1), noise 0.5: the posterior is normal with variance 1/5
        draws = 0.8 * measured + factor * np.sqrt(0.2) * rng.standard_normal(1000)
        low, high = interval(draws, -np.inf, np.inf)
        hits += low <= truth <= high
    assert least <= hits / 1000 <= most


def test_an_interval_begins_at_a_bound_only_if_the_density_does_not_fall_towards_it():
    rng = np.random.default_rng(0)
    half = np.abs(rng.standard_normal(20_000))
    assert interval(half, 0.0, np.inf) == pytest.approx((0.0, 1.96), abs=0.05)
    assert interval(-half, -np.inf, 0.0) == pytest.approx((-1.96, 0.0), abs=0.05)
    rising = np.sqrt(np.sum(rng.standard_normal((2, 20_000)) ** 2, axis=0))
    assert interval(rising, 0.0, np.inf)[0] > 0.15
    skewed = np.exp(0.5 * rng.standard_normal(20_000))
    assert interval(skewed, 0.0, np.inf)[0] > 0.3


def test_what_speaks_against_draws_goes_with_them(drawn):
    """Into the card, too, which has no other word of a likelihood that was reduced too far."""
    good = drawn[0]
    assert good.account == posterior_of(good, None).message == "converged"
    reduced = dataclasses.replace(good, compression=CompressionError(0.3, 0.12, 500.0))
    assert reduced.account.startswith("converged; the likelihood was reduced too far")
    assert "0.3 standard deviations" in reduced.account
    assert posterior_of(reduced, None).message == reduced.account
    slow = dataclasses.replace(good.convergence, tau=np.full(7, 1e6))
    slow = dataclasses.replace(reduced, convergence=slow, message="not converged: no time")
    assert "no time (" in slow.account
    assert "need a longer chain" in slow.account
    assert "reduced too far" in slow.account
