"""How often 95 % intervals of the posterior contain the truth, if Σ is known and if it is not.

The same campaigns as of `coverage.py`, fewer of them: a posterior takes most of a minute.  Every
finished campaign is one line of a work file, so that a study goes on where it was.
"""

import os
import time
from collections.abc import Sequence
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from interval_campaign import PROGRAM, fitted
from interval_rows import CARD, MISFITS, Measured, row_of, say_shares, study
from outcome import Outcome

KINDS: Final = {
    "posterior": "posterior",
    "sure": "posterior, Σ taken for known",
    "profile": "profiles under Σ",
    CARD: "values of Eq. 11 under Σ, along profiles (the card's)",
}
BUDGET: Final = 45.0
"""s, of one posterior."""


def main() -> None:
    study(
        __doc__, "posterior_coverage", campaigns=40, first_seed=61_000_000, work=work,
        program=PROGRAM, page=make_page,
    )  # fmt: skip


def work(name: str) -> dict[str, Any]:
    """One campaign by its name: what its intervals say of the truth."""
    return row_of(name, intervals, PROGRAM)


def intervals(seed: int, percent: float) -> Measured:
    """Intervals of one campaign's free parameters, the truth, the laws' error and the time."""
    from dataclasses import replace

    from sysid.uncertainty.error_model import error_model, errors_at, errors_at_best
    from sysid.uncertainty.profiles import profiles
    from sysid.uncertainty.propagated import by_eq_11
    from sysid.uncertainty.sample import observed_of, sample_posterior

    trial, fit, design = fitted(seed, percent)
    observed = observed_of(fit, trial.loops)
    errors = errors_at(fit, observed)
    full = error_model(fit, observed, "full", errors_at_best(fit, observed, errors))
    begin = time.perf_counter()
    drawn = sample_posterior(fit, trial.loops, errors=full, budget=BUDGET)
    took = time.perf_counter() - begin
    known = replace(full, spread=None)
    sure = sample_posterior(fit, trial.loops, errors=known, budget=BUDGET)
    found = {
        "posterior": drawn.parameters,
        "sure": sure.parameters,
        "profile": profiles(fit, full),
        CARD: by_eq_11(fit, trial.loops, errors).parameters,
    }
    free = fit.coordinates.free
    ends = {
        kind: {p.symbol: (p.low, p.high, p.identified) for p in each if p.symbol in free}
        for kind, each in found.items()
    }
    return Measured(ends, {s: trial.truth.parameters[s] for s in free}, design.misfit, took)


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """Shares of every kind of interval, and of every parameter."""
    outcome = Outcome("posterior_coverage", "Coverage of the posterior's 95 % intervals")
    outcome.say(
        "Campaigns of [coverage](coverage.md), as described there, and posteriors under the full",
        f"likelihood, of {BUDGET:.0f} s at most.  Only what a kind of interval calls identified",
        "counts; half widths are medians over campaigns of medians over parameters that all kinds",
        "do.",
    )
    for misfit in MISFITS:
        say_shares(outcome, rows, KINDS, misfit)
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors."
    )
    return outcome


if __name__ == "__main__":
    main()
