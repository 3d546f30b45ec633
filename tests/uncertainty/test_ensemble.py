"""The three traps of emcee, closed."""

import emcee
import numpy as np
import pytest

from sysid.uncertainty.ensemble import Walkers, random_state, walk
from sysid.uncertainty.jump import jump_of

N = 3
JUMP = jump_of(np.zeros(N), np.eye(N))


def target(u: np.ndarray) -> np.ndarray:
    return -0.5 * np.sum(u**2, axis=1)


def start(stream: int = 0) -> Walkers:
    u = np.random.default_rng(5).standard_normal((24, N))
    return Walkers(u, target(u), random_state(7, stream))


def test_draws_do_not_depend_on_what_numpy_did_before():
    np.random.seed(1)
    one = walk(target, start(), 20, JUMP)
    np.random.seed(2)
    np.random.standard_normal(100)
    assert np.array_equal(one.u, walk(target, start(), 20, JUMP).u)


def test_ensembles_of_one_seed_differ_and_of_another_seed_too():
    one = walk(target, start(0), 20, JUMP).u[-1]
    assert not np.array_equal(one, walk(target, start(1), 20, JUMP).u[-1])
    assert not np.array_equal(random_state(7, 0).keys, random_state(8, 0).keys)


def test_steps_are_the_same_however_they_are_split():
    whole = walk(target, start(), 30, JUMP)
    first = walk(target, start(), 13, JUMP)
    second = walk(target, first.end, 17, JUMP)
    assert np.array_equal(whole.u, np.concatenate([first.u, second.u]))
    assert np.array_equal(whole.end.random.keys, second.end.random.keys)
    assert np.array_equal(whole.end.random.rest, second.end.random.rest)
    assert np.array_equal(whole.end.u, whole.u[-1])


def test_a_state_that_emcee_does_not_take_is_an_error(monkeypatch):
    def swallow(self, state):
        """As emcee's setter does with a state that it cannot read."""

    broken = property(emcee.EnsembleSampler.random_state.fget, swallow)
    monkeypatch.setattr(emcee.EnsembleSampler, "random_state", broken)
    with pytest.raises(RuntimeError, match="did not take"):
        walk(target, start(), 5, JUMP)
