"""Moves against densities whose moments are known, and the one of emcee's that is wrong."""

import emcee
import numpy as np
import pytest

from sysid.uncertainty.ensemble import Walkers, random_state, walk
from sysid.uncertainty.jump import Jump, jump_of

N, WALKERS, STEPS = 5, 48, 1500


def normal(u: np.ndarray) -> np.ndarray:
    return -0.5 * np.sum(u**2, axis=1)


def skewed(u: np.ndarray) -> np.ndarray:
    """ln of independent exponential variables: a long tail to the left, as at a bound."""
    return np.sum(u - np.exp(u), axis=1)


def drawn(target, jump: Jump | None) -> np.ndarray:
    start = 0.3 * np.random.default_rng(1).standard_normal((WALKERS, N))
    walked = walk(target, Walkers(start, target(start), random_state(3, 0)), STEPS, jump)
    return walked.u[200:].reshape(-1, N)


@pytest.mark.parametrize(
    "jump",
    [
        None,
        jump_of(np.zeros(N), np.eye(N)),
        jump_of(np.full(N, 0.5), 2.0 * np.eye(N)),
        jump_of(np.zeros(N), 0.5 * np.eye(N)),
    ],
    ids=["no jumps", "right", "too wide", "too narrow"],
)
def test_draws_are_those_of_the_density_whether_or_not_jumps_fit_it(jump):
    u = drawn(normal, jump)
    assert np.mean(u, axis=0) == pytest.approx(np.zeros(N), abs=0.08)
    assert np.mean(u**2) == pytest.approx(1.0, abs=0.03)
    assert np.mean(u**4) == pytest.approx(3.0, abs=0.2)


def test_a_long_tail_is_reached_though_jumps_have_a_symmetric_one():
    u = drawn(skewed, jump_of(np.full(N, -0.6), 1.6 * np.eye(N)))
    assert np.mean(np.exp(u)) == pytest.approx(1.0, abs=0.04)
    assert np.mean(u < np.log(0.01)) == pytest.approx(1.0 - np.exp(-0.01), rel=0.25)


def test_the_snooker_move_of_emcee_is_still_wrong_and_therefore_not_used():
    sampler = emcee.EnsembleSampler(
        WALKERS, N, normal, moves=emcee.moves.DESnookerMove(), vectorize=True
    )
    sampler.random_state = random_state(2, 0).as_tuple()
    sampler.run_mcmc(np.random.default_rng(0).standard_normal((WALKERS, N)), 2000)
    u = sampler.get_chain(discard=300, flat=True)
    assert np.mean(u**2) < 0.85
