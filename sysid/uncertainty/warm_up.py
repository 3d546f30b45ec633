"""Before the first draw counts: a mode, a reduced likelihood, walkers in place, jumps that fit."""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Final

import numpy as np
from emcee.autocorr import integrated_time
from jaxtyping import Float

from sysid.errors import FitError
from sysid.uncertainty.chain import Course, walk_all
from sysid.uncertainty.doubt import Doubt, doubt_of
from sysid.uncertainty.ensemble import RandomState, Steps, Walkers, random_state
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.jump import Jump, jump_fitted, jump_of, mixture_fitted
from sysid.uncertainty.mode import Mode, find_mode
from sysid.uncertainty.prior import Prior
from sysid.uncertainty.reduced import Reduced, reduce_likelihood
from sysid.uncertainty.target import (
    CALL,
    Target,
    exact_log_likelihood,
    few_points,
    harmonics_at,
    log_prior,
    target_of,
)

ENSEMBLES: Final = 4
WALKERS: Final = 3
"""Walkers of an ensemble, in parameters; emcee asks for twice as many as parameters at least."""
FIRST: Final = 300
"""Steps without jumps, from around the mode into the posterior."""
SECOND: Final = 400
"""Steps with jumps fitted to the first ones."""
THIRD: Final = 400
"""Steps with jumps fitted to those before, where walkers were slow in them."""
AGAIN: Final = 3
"""Such stages at most."""
SLOW: Final = 0.04
"""Autocorrelation time of a stage, in its steps, from which walkers are called slow."""
TRAINING: Final = 400
"""Places that the reduced likelihood is found from."""
TRIES: Final = 50
SPREAD: Final = 50.0
"""Training draws less probable than the mode by more than this, in log-probability and beyond what
is usual for so many parameters, would only teach what no chain ever sees."""


@dataclass(frozen=True)
class Ready:
    """All that sampling needs; from here on nothing adapts.

    Attributes:
        target: Log-probability.
        reduced: Its likelihood.
        doubt: How much less certain it is for not knowing its covariance.
        course: Jumps and start of each ensemble.
        evaluations: Of the log-probability, so far.
    """

    target: Target
    reduced: Reduced
    doubt: Doubt
    course: Course
    evaluations: int


def walkers_for(n: int) -> int:
    """Walkers of an ensemble for n parameters: each half of it fills calls of the target."""
    return 2 * CALL * -(-WALKERS * n // (2 * CALL))


def warm_up(
    prior: Prior,
    errors: ErrorModel,
    executor: Executor,
    seed: int,
    progress: Callable[[str], None],
    *,
    memoryless: bool,
    deadline: float = np.inf,
) -> Ready:
    """Find the mode, walk into the posterior, fit what makes walking fast.

    Each ensemble has its own start and its own random numbers; ensembles know of one another only
    through the reduced likelihood and the density of jumps, which are the same for all.  Neither
    changes what the draws converge to, the one within its measured error, the other not at all.

    Args:
        prior: Of u.
        errors: The likelihood.
        executor: Ensembles are walked side by side in it.
        seed: Everything random follows from it.
        progress: Called with a line now and then.
        memoryless: The model can be computed at single points.
        deadline: Of `time.monotonic`; after it each stage ends at its next block, however short.

    Raises:
        FitError: No place with a finite probability is found.
    """
    progress("posterior: looking for its mode")
    mode, doubt = find_mode(prior, errors), doubt_of(prior.coordinates, errors)
    rng = np.random.default_rng([seed, ENSEMBLES])
    centre = harmonics_at(prior, errors.observed, mode.u[None])[0]
    wide = jump_of(mode.u, mode.covariance)
    places = _plausible(prior, errors, mode, wide.draw(TRAINING, rng))

    def reduce(at: np.ndarray) -> Reduced:
        draws = harmonics_at(prior, errors.observed, at)
        found = reduce_likelihood(errors.observed, errors.covariance, centre, draws, doubt.weights)
        return few_points(prior, errors, found, at) if memoryless else found

    count = walkers_for(mode.u.size)
    states = [random_state(seed, k) for k in range(ENSEMBLES)]
    target = target_of(prior, errors, reduce(places), doubt)
    progress("posterior: warming up")
    starts = [
        Walkers(u, target(u), state)
        for state in states
        for u in (_start(target, mode, wide, count, state),)
    ]
    first = walk_all(executor, target, starts, FIRST, [None] * ENSEMBLES, deadline)
    seen = np.concatenate([_some(steps, rng, TRAINING // ENSEMBLES) for steps in first])
    target = target_of(prior, errors, reduce(np.concatenate([places, seen])), doubt)
    second = walk_all(executor, target, _ends(target, first), SECOND, _jumps(first), deadline)
    seen = np.concatenate([_some(steps, rng, TRAINING // 2) for steps in second])
    reduced = reduce(np.concatenate([places, seen]))
    target = target_of(prior, errors, reduced, doubt)
    late = _together(second)
    late = late[len(late) // 4 :]
    walked, steps, jump = second, len(first[0].u) + len(second[0].u), mixture_fitted(late, rng)
    for _ in range(AGAIN):
        if not _slow(walked) or time.monotonic() > deadline:
            break
        progress("posterior: warming up once more, for walkers were slow")
        starts = _ends(target, walked)
        walked = walk_all(executor, target, starts, THIRD, [jump] * ENSEMBLES, deadline)
        late = np.concatenate([late, _together(walked)])
        steps, jump = steps + len(walked[0].u), mixture_fitted(late, rng)
    course = Course(target, (jump,) * ENSEMBLES, tuple(_ends(target, walked)))
    return Ready(target, reduced, doubt, course, ENSEMBLES * count * steps)


def _plausible(prior: Prior, errors: ErrorModel, mode: Mode, u: np.ndarray) -> np.ndarray:
    """Of some places those that a chain could ever see."""

    def height(at: np.ndarray) -> np.ndarray:
        return exact_log_likelihood(prior, errors, at) + log_prior(prior, at)

    low = height(mode.u[None])[0] - SPREAD - 2.0 * mode.u.size
    return u[height(u) > low]


def _start(
    target: Target, mode: Mode, wide: Jump, count: int, state: RandomState
) -> Float[np.ndarray, "walker n"]:
    """Places of finite probability about the mode, closer where there are none further out."""
    random = np.random.RandomState()
    random.set_state(state.as_tuple())
    u = wide.draw(count, random)
    for _ in range(TRIES):
        bad = ~np.isfinite(target(u))
        if not bad.any():
            return u
        u[bad] = mode.u + 0.5 * (u[bad] - mode.u)
    raise FitError(
        "no parameters with a finite probability were found, so there is no posterior",
        advice="Use --no-posterior, or look whether the fit itself can be trusted",
    )


def _some(steps: Steps, rng: np.random.Generator, count: int) -> np.ndarray:
    """Places out of the second half of steps."""
    late = steps.u[len(steps.u) // 2 :].reshape(-1, steps.u.shape[2])
    return late[rng.choice(len(late), size=min(count, len(late)), replace=False)]


def _jumps(walked: Sequence[Steps]) -> list[Jump]:
    return [jump_fitted(s.u[len(s.u) // 3 :].reshape(-1, s.u.shape[2])) for s in walked]


def _together(walked: Sequence[Steps]) -> Float[np.ndarray, "step walker n"]:
    """Places of the walkers of all ensembles."""
    return np.concatenate([steps.u for steps in walked], axis=1)


def _slow(walked: Sequence[Steps]) -> bool:
    """Walkers have moved too little for the density of jumps to be known well."""
    with np.errstate(invalid="ignore"):  # of walkers that did not move at all
        taus = [integrated_time(steps.u, quiet=True, tol=0) for steps in walked]
    return not bool(np.max(taus) <= SLOW * len(walked[0].u))


def _ends(target: Target, walked: Sequence[Steps]) -> list[Walkers]:
    """Where ensembles stand, under a target that may be a new one."""
    return [Walkers(s.end.u, target(s.end.u), s.end.random) for s in walked]
