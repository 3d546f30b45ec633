"""How often 95 % intervals of the posterior contain the truth, also under a prior that is far off.

The same campaigns as of `coverage.py`, fewer of them: a posterior takes most of a minute.  Every
finished campaign is one line of a work file, so that a study goes on where it was.
"""

import os
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from interval_campaign import PROGRAM, fitted
from interval_rows import CARD, MISFITS, Measured, row_of, say_shares, study
from outcome import Outcome

if TYPE_CHECKING:
    from sysid.uncertainty.posterior import Posterior
    from sysid.uncertainty.prior import Prior

FACTOR: Final = 4.0
KINDS: Final = {
    "posterior": "posterior",
    "far": f"posterior, each typical magnitude of the prior wrong by a factor of up to {FACTOR:g}",
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

    import numpy as np

    from sysid.uncertainty.error_model import error_model, errors_at, errors_at_best
    from sysid.uncertainty.prior import prior_of
    from sysid.uncertainty.profiles import profiles
    from sysid.uncertainty.propagated import by_eq_11
    from sysid.uncertainty.sample import observed_of, sample_posterior

    trial, fit, design = fitted(seed, percent)
    observed = observed_of(fit, trial.loops)
    errors = errors_at(fit, observed)
    full = error_model(fit, observed, "full", errors_at_best(fit, observed, errors))
    alone = profiles(fit, full)
    prior = prior_of(fit.coordinates, full.u)
    wrong = FACTOR ** np.random.default_rng(seed).uniform(-1.0, 1.0, len(prior.declared))
    far = replace(
        prior,
        declared=tuple(
            replace(spec, typical=float(spec.typical * f))
            for spec, f in zip(prior.declared, wrong, strict=True)
        ),
    )

    def drawn_under(prior: "Prior") -> "Posterior":
        return sample_posterior(
            fit, trial.loops, errors=full, prior=prior, profiles=alone, budget=BUDGET
        )

    begin = time.perf_counter()
    drawn = drawn_under(prior)
    took = time.perf_counter() - begin
    found = {
        "posterior": drawn.parameters,
        "far": drawn_under(far).parameters,
        "profile": alone,
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
        "do.  The prior of declarations has dampers like the rig's in its middle; the other one",
        "tells how much of what intervals hold is owed to that.",
    )
    for misfit in MISFITS:
        say_shares(outcome, rows, KINDS, misfit)
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors."
    )
    return outcome


if __name__ == "__main__":
    main()
