"""Entry point: from a fit to draws from its posterior."""

import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid import __version__
from sysid.data.loops import Loops
from sysid.identification.families import family
from sysid.identification.result import Fit
from sysid.likelihood.compress import HARMONICS
from sysid.likelihood.observed import Observed, observe
from sysid.uncertainty.chain import (
    BLOCK,
    Block,
    course_arrays,
    course_of,
    draws_of,
    grow,
)
from sysid.uncertainty.chain_store import ChainStore
from sysid.uncertainty.compression import CompressionError, compression_error
from sysid.uncertainty.convergence import Convergence, convergence
from sysid.uncertainty.doubt import doubt_of
from sysid.uncertainty.error_model import ErrorModel, Likelihood, error_model
from sysid.uncertainty.estimate import Estimate
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.prior import Prior, prior_of
from sysid.uncertainty.profiles import Profile
from sysid.uncertainty.reduced import Reduced
from sysid.uncertainty.target import exact_log_likelihood, parameters_at, target_of
from sysid.uncertainty.warm_up import Ready, warm_up

BUDGET: Final = 90.0
"""Seconds after which sampling ends, converged or not."""
CHECKED: Final = 1000
"""Draws at which the likelihood is computed without reduction."""


def sample_posterior(
    fit: Fit,
    loops: Loops,
    *,
    likelihood: Likelihood = "full",
    errors: ErrorModel | None = None,
    prior: Prior | None = None,
    profiles: Sequence[Profile] = (),
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
        errors: That likelihood, where it is known already.
        prior: Of the parameters; that of their declarations if None.
        profiles: Of its parameters, where they are known: those that the data leave open on a
            side, though their draws end there, are not called identified (`open_beside`).
        budget: Seconds after which sampling ends, converged or not.
        folder: Where the chain grows, so that it can go on after a kill; nowhere if None.
        progress: Called with a line now and then.

    Raises:
        FitError: No place with a finite probability is found.
        OutputError: The folder cannot be written.
    """
    say = progress or (lambda line: None)
    started = time.monotonic()
    if errors is None:
        errors = errors_of(fit, loops, likelihood)
    if prior is None:
        prior = prior_of(fit.coordinates, errors.u)
    key = _key(fit, loops, errors, prior, seed)
    store = None if folder is None else ChainStore(folder, key)
    names = [spec.symbol for spec in prior.declared]
    with ThreadPoolExecutor(max_workers=_workers()) as executor:
        ready = _kept(store, prior, errors)
        if ready is None:
            memoryless = family(fit.model).memoryless
            ready = warm_up(
                prior, errors, executor, seed, say,
                memoryless=memoryless, deadline=started + budget,
            )  # fmt: skip
            if store is not None:
                store.begin(_setup_arrays(ready))
        blocks, evidence, message = grow(
            ready.course,
            lambda u: convergence(_theta(prior, u), names),
            executor,
            deadline=started + budget,
            store=store,
            say=lambda line: say(f"posterior: {line}"),
        )
    drawn = _posterior(fit, errors, prior, ready, blocks, evidence, message)
    return replace(drawn, open=open_beside(profiles, drawn.parameters))


def open_beside(profiles: Sequence[Profile], drawn: Sequence[Estimate]) -> tuple[str, ...]:
    """Symbols of parameters whose draws end on a side where neither data nor a bound end them.

    Args:
        profiles: Of parameters.
        drawn: What the draws say of them.
    """
    of = {e.symbol: e for e in drawn}
    ends = {p.symbol: p.ended(of[p.symbol].low, of[p.symbol].high) for p in profiles}
    return tuple(symbol for symbol, both in ends.items() if not all(both))


def errors_of(
    fit: Fit, loops: Loops, likelihood: Likelihood, near: ErrorModel | None = None
) -> ErrorModel:
    """The likelihood of a fit on its loops.

    Args:
        fit: The fit.
        loops: Those that were fitted.
        likelihood: Its kind.
        near: Σ at the most probable parameters (`errors_at_best`), where it is known already.
    """
    return error_model(fit, observed_of(fit, loops), likelihood, near)


def observed_of(fit: Fit, loops: Loops, harmonics: int = HARMONICS) -> Observed:
    """The loops of a fit in harmonics, on the points that its model is simulated on.

    Args:
        fit: The fit.
        loops: Those that were fitted.
        harmonics: To compare, where the points carry as many.
    """
    return observe(loops, points=points_for(fit.model, loops), harmonics=harmonics)


def points_for(model: str, loops: Loops) -> int:
    """Points a loop is simulated on.

    A model without memory is simulated on the measured points: it will be computed at few of them
    anyway, and on fewer points the jump of its force at each reversal would be folded into lower
    harmonics, which moves parameters by a standard deviation and more.

    Args:
        model: Its name.
        loops: As measured.
    """
    kind = family(model)
    return loops.force.shape[1] if kind.memoryless else kind.points_for(loops)


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
    u = draws_of(blocks)
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
    exact = exact_log_likelihood(prior, errors, some, ready.doubt)
    return compression_error(some, exact - ready.target.log_likelihood(some))


def _workers() -> int:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1, min(4, cores or 1))


def _key(fit: Fit, loops: Loops, errors: ErrorModel, prior: Prior, seed: int) -> str:
    """Everything that a chain depends on: motion, measurement, Σ, and where it starts."""
    digest = sha256()
    parts = errors.observed.parts
    for array in (
        loops.displacement, loops.velocity, loops.force, loops.current, loops.frequency,
        loops.temperature, fit.u, errors.u, errors.observed.measured, parts.noise, parts.kernel,
        parts.laws, parts.warmth,
    ):  # fmt: skip
        digest.update(repr(np.shape(array)).encode())
        digest.update(np.ascontiguousarray(array, dtype=float).tobytes())
    for one in errors.believed():
        spread = np.zeros(0) if one.spread is None else one.spread
        digest.update(repr((one.weight, one.lengths, one.sizes)).encode() + spread.tobytes())
    believed = (errors.kind, errors.sizes, errors.power)
    head = (__version__, fit.model, fit.variant, fit.weights, believed, prior.words(), seed, BLOCK)
    digest.update(repr(head).encode())
    return digest.hexdigest()


def _kept(store: ChainStore | None, prior: Prior, errors: ErrorModel) -> Ready | None:
    """The set-up of a chain that was cut off; None if there is none."""
    kept = None if store is None else store.setup()
    if kept is None:
        return None
    reduced = Reduced(kept["B"], kept["a"], float(kept["rest"]), kept["points"])
    doubt = doubt_of(prior.coordinates, errors)
    target = target_of(prior, errors, reduced, doubt)
    return Ready(target, reduced, doubt, course_of(kept, target), int(kept["evaluations"]))


def _setup_arrays(ready: Ready) -> dict[str, np.ndarray]:
    return {
        "B": ready.reduced.B,
        "a": ready.reduced.a,
        "rest": np.array(ready.reduced.rest),
        "points": ready.reduced.points,
        "evaluations": np.array(ready.evaluations),
        **course_arrays(ready.course),
    }
