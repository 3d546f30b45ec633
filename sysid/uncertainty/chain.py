"""A chain of four ensembles that grows in blocks until its draws have converged."""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.uncertainty.chain_store import ChainStore
from sysid.uncertainty.convergence import LENGTHS, Convergence
from sysid.uncertainty.ensemble import RandomState, Steps, Walkers, joined, walk
from sysid.uncertainty.jump import Jump
from sysid.uncertainty.target import LogProbability

BLOCK: Final = 50
"""Steps of a block; blocks are stored whole."""
FIRST_LOOK: Final = 400
"""Steps after which convergence is measured for the first time."""


@dataclass(frozen=True)
class Course:
    """What the steps of a chain follow from; nothing in it adapts.

    Attributes:
        target: Log-probability of places.
        jumps: Of each ensemble.
        start: Of each ensemble.
    """

    target: LogProbability
    jumps: tuple[Jump, ...]
    start: tuple[Walkers, ...]


@dataclass(frozen=True)
class Block:
    """Some steps of all ensembles.

    Attributes:
        u: [e, t, w, n].
        log_probability: [e, t, w].
        accepted: [e] share of accepted moves.
        ends: Where ensembles stand after it.
    """

    u: Float[np.ndarray, "ensemble step walker n"]
    log_probability: Float[np.ndarray, "ensemble step walker"]
    accepted: Float[np.ndarray, " ensemble"]
    ends: tuple[Walkers, ...]


def grow(
    course: Course,
    evidence_of: Callable[[Float[np.ndarray, "ensemble step walker n"]], Convergence],
    executor: Executor,
    *,
    deadline: float,
    store: ChainStore | None = None,
    say: Callable[[str], None] | None = None,
) -> tuple[list[Block], Convergence, str]:
    """Add blocks until the draws have converged, time is up, or Ctrl-C is pressed.

    When convergence is looked at follows from the number of steps alone, so a chain that was cut
    off at any moment and goes on from its stored blocks ends at the same step with the same draws.

    Args:
        course: What its steps follow from.
        evidence_of: Draws → convergence.
        executor: Ensembles are walked side by side in it.
        deadline: Of `time.monotonic`.
        store: Where blocks are kept, and found if there are any.
        say: Called with a line a block.

    Returns:
        Blocks, convergence, and how it ended.
    """
    blocks = [] if store is None else [_block_of(arrays) for arrays in store.blocks()]
    look, message = FIRST_LOOK, ""
    try:
        while True:
            steps = BLOCK * len(blocks)
            if steps >= look:
                upto = blocks[: look // BLOCK]
                evidence = evidence_of(draws_of(upto))
                if evidence.reached:
                    return upto, evidence, "converged"
                look = _next_look(look, evidence)
            elif time.monotonic() > deadline and blocks:
                message = "the time budget was spent"
                break
            else:
                blocks.append(_next_block(course, blocks, store, executor))
                if say is not None:
                    say(f"{steps + BLOCK} steps, convergence is looked at after {look}")
    except KeyboardInterrupt:
        if not blocks:
            raise
        message = "interrupted"
    evidence = evidence_of(draws_of(blocks))
    return blocks, evidence, "converged" if evidence.reached else f"not converged: {message}"


def draws_of(blocks: Sequence[Block]) -> Float[np.ndarray, "ensemble step walker n"]:
    """Places of all blocks."""
    return np.concatenate([b.u for b in blocks], axis=1)


def walk_all(
    executor: Executor,
    target: LogProbability,
    starts: Sequence[Walkers],
    steps: int,
    jumps: Sequence[Jump | None],
    deadline: float = np.inf,
) -> list[Steps]:
    """Walk every ensemble on, side by side.

    Args:
        executor: Ensembles are walked side by side in it.
        target: Log-probability of places.
        starts: Where ensembles stand.
        steps: How many.
        jumps: Of each ensemble.
        deadline: Of `time.monotonic`; no block of steps begins after it but the first.
    """
    walked: list[list[Steps]] = [[] for _ in starts]
    here, left = list(starts), steps
    while left and (left == steps or time.monotonic() < deadline):
        count = left if deadline == np.inf else min(BLOCK, left)
        going = [
            executor.submit(walk, target, start, count, jump)
            for start, jump in zip(here, jumps, strict=True)
        ]
        for own, one in zip(walked, going, strict=True):
            own.append(one.result())
        here, left = [own[-1].end for own in walked], left - count
    return [joined(own) for own in walked]


def _next_look(look: int, evidence: Convergence) -> int:
    """When convergence is to be measured again: by steps alone, so that a chain can go on."""
    longest = float(np.max(evidence.tau, where=np.isfinite(evidence.tau), initial=0.0))
    wanted = max(1.25 * look, min(1.05 * LENGTHS * longest, 4.0 * look))
    return BLOCK * -(-int(wanted) // BLOCK)


def _next_block(
    course: Course, blocks: Sequence[Block], store: ChainStore | None, executor: Executor
) -> Block:
    starts = blocks[-1].ends if blocks else course.start
    walked = walk_all(executor, course.target, starts, BLOCK, course.jumps)
    block = Block(
        u=np.stack([s.u for s in walked]),
        log_probability=np.stack([s.log_probability for s in walked]),
        accepted=np.array([s.accepted.mean() / BLOCK for s in walked]),
        ends=tuple(s.end for s in walked),
    )
    if store is not None:
        store.append(len(blocks), _arrays_of(block))
    return block


def _arrays_of(block: Block) -> dict[str, np.ndarray]:
    return {
        "u": block.u,
        "log_probability": block.log_probability,
        "accepted": block.accepted,
        **random_arrays(block.ends),
    }


def _block_of(arrays: Mapping[str, np.ndarray]) -> Block:
    u, height = arrays["u"], arrays["log_probability"]
    ends = walkers_of(arrays, u[:, -1], height[:, -1])
    return Block(u, height, arrays["accepted"], ends)


def course_arrays(course: Course) -> dict[str, np.ndarray]:
    """Jumps and start, to be stored: name → array, ensembles along the first axis.

    Returns:
        Arrays of the shapes that `Jump` and `Walkers` tell, stacked.
    """
    return {
        "weight": np.stack([j.weight for j in course.jumps]),
        "mean": np.stack([j.mean for j in course.jumps]),
        "root": np.stack([j.root for j in course.jumps]),
        "u": np.stack([w.u for w in course.start]),
        "height": np.stack([w.log_probability for w in course.start]),
        **random_arrays(course.start),
    }


def course_of(arrays: Mapping[str, np.ndarray], target: LogProbability) -> Course:
    """What `course_arrays` stored, in its shapes."""
    parts = zip(arrays["weight"], arrays["mean"], arrays["root"], strict=True)
    jumps = tuple(Jump(weight, mean, root) for weight, mean, root in parts)
    return Course(target, jumps, walkers_of(arrays, arrays["u"], arrays["height"]))


def random_arrays(walkers: Sequence[Walkers]) -> dict[str, np.ndarray]:
    """States of the generators of E ensembles: keys [E, 624] and rest [E, 3]."""
    return {
        "keys": np.stack([w.random.keys for w in walkers]),
        "random": np.stack([w.random.rest for w in walkers]),
    }


def walkers_of(
    arrays: Mapping[str, np.ndarray], u: np.ndarray, height: np.ndarray
) -> tuple[Walkers, ...]:
    """E ensembles at places, with the generators of `random_arrays`.

    Args:
        arrays: What `random_arrays` gave, in its shapes.
        u: [E, walker, n] places.
        height: [E, walker] log probability there.
    """
    return tuple(
        Walkers(np.array(a), np.array(b), RandomState(keys.astype(np.uint32), rest))
        for a, b, keys, rest in zip(u, height, arrays["keys"], arrays["random"], strict=True)
    )
