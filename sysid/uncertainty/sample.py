"""Entry point: from a fit to draws from its posterior."""

import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid import __version__
from sysid.data.loops import Loops
from sysid.identification.families import family
from sysid.identification.result import Fit
from sysid.likelihood.observed import observe
from sysid.uncertainty.chain_store import ChainStore
from sysid.uncertainty.compression import CompressionError, compression_error
from sysid.uncertainty.convergence import LENGTHS, Convergence, convergence
from sysid.uncertainty.ensemble import RandomState, Walkers
from sysid.uncertainty.error_model import ErrorModel, Likelihood, error_model
from sysid.uncertainty.moves import Jump
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.prior import Prior, prior_of
from sysid.uncertainty.reduced import Reduced
from sysid.uncertainty.target import exact_log_likelihood, parameters_at, target_of
from sysid.uncertainty.warm_up import Ready, walk_all, warm_up

BUDGET: Final = 60.0
"""Seconds after which sampling ends, converged or not."""
BLOCK: Final = 50
"""Steps of a block; blocks are stored whole."""
FIRST_LOOK: Final = 400
"""Steps after which convergence is measured for the first time."""
CHECKED: Final = 1000
"""Draws at which the likelihood is computed without reduction."""


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


def sample_posterior(
    fit: Fit,
    loops: Loops,
    *,
    likelihood: Likelihood = "full",
    seed: int = 0,
    budget: float = BUDGET,
    folder: Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> Posterior:
    """Draw from the posterior of a fit's parameters until the draws have converged.

    Four independent ensembles of emcee, each longer than 50 autocorrelation times when they agree.
    A result that did not get there says so.  Ctrl-C ends sampling and keeps what was drawn.

    Args:
        fit: The fit; its coordinates are those that chains move in.
        loops: The loops that were fitted, without those held out.
        likelihood: What a right model would still leave.
        seed: Everything random follows from it.
        budget: Seconds after which sampling ends, converged or not.
        folder: Where the chain grows, so that it can go on after a kill; nowhere if None.
        progress: Called with a line now and then.

    Raises:
        FitError: No place with a finite probability is found.
        OutputError: The folder cannot be written.
    """
    say = progress or (lambda line: None)
    started = time.monotonic()
    observed = observe(loops, points=family(fit.model).points)
    errors = error_model(fit, observed, likelihood)
    prior = prior_of(fit.coordinates, errors.u)
    store = None if folder is None else ChainStore(folder, _key(fit, loops, likelihood, seed))
    with ThreadPoolExecutor(max_workers=_workers()) as executor:
        ready, blocks = _resumed(store, prior, errors)
        if ready is None:
            ready = warm_up(prior, errors, executor, seed, say)
            if store is not None:
                store.begin(_setup_arrays(ready))
        blocks, evidence, message = _sampled(
            ready, blocks, store, executor, prior, started + budget, say
        )
    return _posterior(fit, errors, prior, ready, blocks, evidence, message)


def _sampled(
    ready: Ready,
    blocks: list[Block],
    store: ChainStore | None,
    executor: Executor,
    prior: Prior,
    deadline: float,
    say: Callable[[str], None],
) -> tuple[list[Block], Convergence, str]:
    """Blocks until the draws have converged, the budget is spent, or Ctrl-C is pressed."""
    look, message = FIRST_LOOK, ""
    try:
        while True:
            steps = BLOCK * len(blocks)
            if steps >= look:
                evidence = _evidence(blocks[: look // BLOCK], prior)
                if evidence.reached:
                    return blocks[: look // BLOCK], evidence, "converged"
                look = _next_look(look, evidence)
            if steps < look:
                if time.monotonic() > deadline and blocks:
                    message = "the time budget was spent"
                    break
                blocks = [*blocks, _next_block(ready, blocks, store, executor)]
                say(f"posterior: {steps + BLOCK} steps, convergence is looked at after {look}")
    except KeyboardInterrupt:
        if not blocks:
            raise
        message = "interrupted"
    evidence = _evidence(blocks, prior)
    return blocks, evidence, "converged" if evidence.reached else f"not converged: {message}"


def _next_look(look: int, evidence: Convergence) -> int:
    """When convergence is to be measured again: by steps alone, so that a chain can go on."""
    longest = float(np.max(evidence.tau, where=np.isfinite(evidence.tau), initial=0.0))
    wanted = max(1.25 * look, min(1.05 * LENGTHS * longest, 4.0 * look))
    return BLOCK * -(-int(wanted) // BLOCK)


def _next_block(
    ready: Ready, blocks: Sequence[Block], store: ChainStore | None, executor: Executor
) -> Block:
    starts = blocks[-1].ends if blocks else ready.start
    walked = walk_all(executor, ready.target, starts, BLOCK, ready.jumps)
    block = Block(
        u=np.stack([s.u for s in walked]),
        log_probability=np.stack([s.log_probability for s in walked]),
        accepted=np.array([s.accepted.mean() / BLOCK for s in walked]),
        ends=tuple(s.end for s in walked),
    )
    if store is not None:
        store.append(len(blocks), _block_arrays(block))
    return block


def _evidence(blocks: Sequence[Block], prior: Prior) -> Convergence:
    theta = _theta(prior, np.concatenate([b.u for b in blocks], axis=1))
    return convergence(theta, [spec.symbol for spec in prior.declared])


def _theta(prior: Prior, u: np.ndarray) -> np.ndarray:
    """Parameters of places [..., n], some at a time so that one program does for any number."""
    flat, size = u.reshape(-1, u.shape[-1]), 4096
    filled = np.concatenate([flat, np.repeat(flat[-1:], -len(flat) % size, axis=0)])
    parts = [parameters_at(prior, filled[k : k + size]) for k in range(0, len(filled), size)]
    return np.concatenate(parts)[: len(flat)].reshape(u.shape)


def _posterior(
    fit: Fit,
    errors: ErrorModel,
    prior: Prior,
    ready: Ready,
    blocks: Sequence[Block],
    evidence: Convergence,
    message: str,
) -> Posterior:
    u = np.concatenate([b.u for b in blocks], axis=1)
    ensembles, steps, walkers, n = u.shape
    flat = u.reshape(ensembles, -1, n)
    return Posterior(
        model=fit.model,
        variant=fit.variant,
        likelihood=errors.kind,
        assumed=errors.words,
        prior=prior.words(),
        declared=prior.declared,
        coordinates=flat,
        draws=_theta(prior, flat),
        log_probability=np.concatenate([b.log_probability for b in blocks], axis=1).reshape(
            ensembles, -1
        ),
        walkers=walkers,
        convergence=evidence,
        compression=_reduction_error(prior, errors, ready, flat.reshape(-1, n)),
        acceptance=float(np.mean([b.accepted for b in blocks])),
        evaluations=ready.evaluations + ensembles * steps * walkers,
        message=message,
    )


def _reduction_error(
    prior: Prior, errors: ErrorModel, ready: Ready, u: Float[np.ndarray, "draw n"]
) -> CompressionError:
    some = u[np.linspace(0, len(u) - 1, min(CHECKED, len(u))).astype(int)]
    exact = exact_log_likelihood(prior, errors, some)
    return compression_error(some, exact - ready.target.log_likelihood(some))


def _workers() -> int:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1, min(4, cores or 1))


def _key(fit: Fit, loops: Loops, likelihood: str, seed: int) -> str:
    """Everything that a chain depends on."""
    digest = sha256()
    for array in (loops.displacement, loops.velocity, loops.force, loops.current, fit.u):
        digest.update(np.ascontiguousarray(array, dtype=float).tobytes())
    head = (__version__, fit.model, fit.variant, fit.weights, likelihood, seed, BLOCK)
    digest.update(repr(head).encode())
    return digest.hexdigest()


def _resumed(
    store: ChainStore | None, prior: Prior, errors: ErrorModel
) -> tuple[Ready | None, list[Block]]:
    """What a chain that was cut off has left; nothing if there is none."""
    kept = None if store is None else store.setup()
    if store is None or kept is None:
        return None, []
    reduced = Reduced(kept["B"], kept["a"], float(kept["rest"]))
    ready = Ready(
        target=target_of(prior, errors, reduced),
        reduced=reduced,
        jumps=tuple(Jump(m, r) for m, r in zip(kept["mean"], kept["root"], strict=True)),
        start=_walkers(kept, kept["u"], kept["height"]),
        evaluations=int(kept["evaluations"]),
    )
    return ready, [
        Block(
            u=b["u"],
            log_probability=b["log_probability"],
            accepted=b["accepted"],
            ends=_walkers(b, b["u"][:, -1], b["log_probability"][:, -1]),
        )
        for b in store.blocks()
    ]


def _walkers(
    arrays: dict[str, np.ndarray], u: np.ndarray, height: np.ndarray
) -> tuple[Walkers, ...]:
    return tuple(
        Walkers(np.array(a), np.array(b), RandomState(keys.astype(np.uint32), rest))
        for a, b, keys, rest in zip(u, height, arrays["keys"], arrays["random"], strict=True)
    )


def _setup_arrays(ready: Ready) -> dict[str, np.ndarray]:
    return {
        "B": ready.reduced.B,
        "a": ready.reduced.a,
        "rest": np.array(ready.reduced.rest),
        "mean": np.stack([j.mean for j in ready.jumps]),
        "root": np.stack([j.root for j in ready.jumps]),
        "u": np.stack([w.u for w in ready.start]),
        "height": np.stack([w.log_probability for w in ready.start]),
        "evaluations": np.array(ready.evaluations),
        **_random_arrays(ready.start),
    }


def _block_arrays(block: Block) -> dict[str, np.ndarray]:
    return {
        "u": block.u,
        "log_probability": block.log_probability,
        "accepted": block.accepted,
        **_random_arrays(block.ends),
    }


def _random_arrays(walkers: Sequence[Walkers]) -> dict[str, np.ndarray]:
    return {
        "keys": np.stack([w.random.keys for w in walkers]),
        "random": np.stack([w.random.rest for w in walkers]),
    }
