"""One emcee ensemble, with emcee's traps closed.

Three things go wrong silently with emcee 3.1, and all of them are dealt with here and nowhere else:

- a new sampler takes the state of NumPy's *global* generator, so it depends on whatever ran before
  and two samplers made in a row are the same: every ensemble here is given a state of its own;
- assigning `random_state` swallows every error and keeps the old state: it is read back;
- `vectorize=True`, without which nothing is fast, refuses named parameters: names stay outside.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import emcee
import numpy as np
from jaxtyping import Float, UInt32

from sysid.uncertainty.jump import Jump
from sysid.uncertainty.moves import moves
from sysid.uncertainty.target import LogProbability

GENERATOR: Final = "MT19937"


@dataclass(frozen=True)
class RandomState:
    """State of a Mersenne twister, as arrays that can be stored.

    Attributes:
        keys: [624].
        rest: [3] position, whether a normal number is in store, and that number.
    """

    keys: UInt32[np.ndarray, " 624"]
    rest: Float[np.ndarray, " 3"]

    def as_tuple(self) -> tuple[str, np.ndarray, int, int, float]:
        """As NumPy and emcee take it, the keys as [624]."""
        return GENERATOR, self.keys, int(self.rest[0]), int(self.rest[1]), float(self.rest[2])


def random_state(seed: int, stream: int) -> RandomState:
    """The state of one of many independent streams of a seed."""
    words = np.random.SeedSequence([seed, stream]).generate_state(8)
    return _stored(np.random.RandomState(words).get_state())


@dataclass(frozen=True)
class Walkers:
    """Where an ensemble stands.

    Attributes:
        u: [w, n].
        log_probability: [w].
        random: State of its own generator.
    """

    u: Float[np.ndarray, "walker n"]
    log_probability: Float[np.ndarray, " walker"]
    random: RandomState


@dataclass(frozen=True)
class Steps:
    """What an ensemble went through.

    Attributes:
        u: [t, w, n].
        log_probability: [t, w].
        accepted: [w] moves that were accepted.
        end: Where it stands now.
    """

    u: Float[np.ndarray, "step walker n"]
    log_probability: Float[np.ndarray, "step walker"]
    accepted: Float[np.ndarray, " walker"]
    end: Walkers


def joined(parts: Sequence[Steps]) -> Steps:
    """Steps of an ensemble that were walked one after another."""
    return Steps(
        u=np.concatenate([part.u for part in parts]),
        log_probability=np.concatenate([part.log_probability for part in parts]),
        accepted=np.sum([part.accepted for part in parts], axis=0),
        end=parts[-1].end,
    )


def walk(log_probability: LogProbability, start: Walkers, steps: int, jump: Jump | None) -> Steps:
    """Move an ensemble on; the same start always gives the same steps, however they are split.

    Args:
        log_probability: Of [w, n] places.
        start: Where it stands.
        steps: How many.
        jump: Density of the independence moves.

    Raises:
        RuntimeError: emcee did not take the random state.
    """
    walkers, n = start.u.shape
    sampler = emcee.EnsembleSampler(walkers, n, log_probability, moves=moves(jump), vectorize=True)
    state = start.random.as_tuple()
    _set_state(sampler, state)
    here = emcee.State(start.u, log_prob=start.log_probability, random_state=state)
    end = sampler.run_mcmc(here, steps, skip_initial_state_check=True)
    if end is None:
        raise RuntimeError("emcee made no step")
    chain, heights = sampler.get_chain(), sampler.get_log_prob()
    return Steps(
        u=np.asarray(chain),
        log_probability=np.asarray(heights),
        accepted=np.asarray(sampler.backend.accepted, dtype=float),
        end=Walkers(np.array(end.coords), np.array(end.log_prob), _stored(sampler.random_state)),
    )


def _set_state(sampler: emcee.EnsembleSampler, state: tuple[Any, ...]) -> None:
    sampler.random_state = state
    taken = sampler.random_state
    same = taken[0] == state[0] and np.array_equal(taken[1], state[1])
    if not same or tuple(taken[2:]) != tuple(state[2:]):
        raise RuntimeError("emcee did not take the random state it was given")


def _stored(state: Any) -> RandomState:
    _, keys, position, in_store, number = state
    return RandomState(np.array(keys, dtype=np.uint32), np.array([position, in_store, number]))
