"""Where Σ is taken: at Eq. 11's values, at the most probable ones, at the truth.

Σ has errors of the laws to first order, by how a loop changes with a law at some parameters.
Profiles under it are told for several such places, with the sizes and the smoothness that REML
finds and with those that the virtual rig drew the errors with.
"""

import os
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from interval_campaign import PROGRAM, fitted
from interval_rows import MISFITS, Interval, Measured, row_of, say_shares, study
from jaxtyping import Float
from outcome import Outcome

from sysid.data.loops import Loops
from sysid.identification.result import Fit
from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import gauss_newton
from sysid.likelihood.kernel import places_of
from sysid.models.coordinates import place_of
from sysid.models.generalized import Generalized
from sysid.parameters import build, specs
from sysid.rig.trial_design import TrialDesign
from sysid.uncertainty.error_model import ErrorModel, error_model, errors_at, errors_at_best
from sysid.uncertainty.profiles import profiles
from sysid.uncertainty.propagated import by_eq_11
from sysid.uncertainty.sample import observed_of

KINDS: Final = {
    "eq_11": "values of Eq. 11 under Σ, along profiles (the card's)",
    "fit": "profiles under Σ by REML, taken at Eq. 11's values",
    "best": "the same, at the most probable parameters under that",
    "full": "the same, fit and Σ settled in turns (the posterior's likelihood)",
    "truth": "the same, at the generator's parameters",
    "known_fit": "profiles under the generator's own Σ, taken at Eq. 11's values",
    "known_best": "the same, at the most probable parameters",
    "known_truth": "the same, at the generator's parameters",
}
LENGTH: Final = 0.6
"""Correlation length of the generator's laws, parts of the ranges."""
RANGES: Final = (np.log(75.0 / 2.5), np.log(15.0 / 0.1), 0.4)
"""Of ln A, ln f and current, A, as `rig.trial_misfit` has them."""
TINY: Final = 1e-9
"""Added to the diagonal of K_c, which is smooth to rounding."""


def main() -> None:
    study(
        __doc__, "place_of_covariance", campaigns=30, first_seed=61_000_100, work=work,
        program=PROGRAM, page=make_page,
    )  # fmt: skip


def work(name: str) -> dict[str, Any]:
    """One campaign by its name: what its intervals say of the truth."""
    return row_of(name, intervals, PROGRAM)


def intervals(seed: int, percent: float) -> Measured:
    """All intervals of one campaign's free parameters, the truth, the laws' error and the time."""
    trial, fit, design = fitted(seed, percent)
    begin = time.perf_counter()
    observed, truth = observed_of(fit, trial.loops), trial.truth.parameters
    made = build(Generalized, {s.symbol: truth[s.symbol] for s in specs(Generalized)})
    at_truth = replace(fit, u=np.asarray(place_of(fit.coordinates, made)))
    found = errors_at(fit, observed)
    best = errors_at_best(fit, observed, found)
    true = errors_at(at_truth, observed)
    likelihoods = {
        "fit": found, "best": best, "full": error_model(fit, observed, "full", best),
        "truth": true, "known_fit": known(fit, found, design),
        "known_best": known(fit, best, design), "known_truth": known(fit, true, design),
    }  # fmt: skip
    free = fit.coordinates.free
    told = by_eq_11(fit, trial.loops, found).parameters
    ends: dict[str, dict[str, Interval]] = {
        "eq_11": {p.symbol: (p.low, p.high, p.identified) for p in told if p.symbol in free}
    }
    for kind, errors in likelihoods.items():
        ends[kind] = {
            p.symbol: (p.low, p.high, p.identified) for p in profiles(fit, errors, threads=1)
        }
    took = time.perf_counter() - begin
    return Measured(ends, {s: truth[s] for s in free}, design.misfit, took)


def known(fit: Fit, errors: ErrorModel, design: TrialDesign) -> ErrorModel:
    """At the same place, with the sizes and the smoothness of the generator's rig and laws.

    Args:
        fit: The fit, for its coordinates.
        errors: By REML.
        design: Of the campaign, with the size of the errors of the laws.
    """
    kernel = rig_kernel(errors.observed.loops)
    sizes = Sizes(
        gain=design.gain_sd, offset=design.offset_sd, delay=design.delay_sd,
        scale=np.sqrt(2.0) * design.misfit,  # it errs in F_t and in C_i, and both scale the force
        width=design.misfit, growth=design.misfit,
    )  # fmt: skip
    observed = replace(errors.observed, parts=replace(errors.observed.parts, kernel=kernel))
    covariance = Covariance(observed.parts, sizes)
    gls = gauss_newton(partial(observed.look, fit.coordinates), errors.u, covariance)
    return replace(
        errors, observed=observed, sizes=sizes, covariance=covariance, u=gls.u,
        information=gls.information,
    )  # fmt: skip


def rig_kernel(loops: Loops) -> Float[np.ndarray, "loop loop"]:
    """Covariance of the virtual rig's errors of a law between tests, for a variance of one."""
    place = places_of(
        loops.amplitude, loops.frequency, loops.current, loops.temperature, 1.0
    )[:, :3]  # fmt: skip
    place /= LENGTH * np.array(RANGES)
    kernel = np.exp(-0.5 * np.sum((place[:, None] - place[None]) ** 2, axis=2))
    return kernel + TINY * np.eye(len(kernel))


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """Shares of every kind of interval."""
    outcome = Outcome("place_of_covariance", "Where Σ is taken")
    outcome.say(
        "Campaigns as in `coverage.py`.  Σ has errors of the laws to first order, by how loops",
        "change with a law at some parameters.  The generator's own Σ has the sizes and the",
        "smoothness that errors of rig and laws were drawn with.",
    )
    for misfit in MISFITS:
        say_shares(outcome, rows, KINDS, misfit)
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors."
    )
    return outcome


if __name__ == "__main__":
    main()
