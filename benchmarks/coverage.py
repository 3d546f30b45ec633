"""How often 95 % intervals of fitted parameters contain the truth, for each kind of interval.

Every finished campaign is one line of a work file, so that a study goes on where it was.
"""

import os
import time
from collections.abc import Sequence
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from interval_campaign import PROGRAM, fitted
from interval_rows import MISFITS, Interval, Measured, row_of, say_shares, study
from outcome import Outcome

KINDS: Final = {
    "eq_11": "values of Eq. 11 under Σ, along profiles (the card's)",
    "eq_11_straight": "the same, ± t standard errors",
    "gls": "values of GLS, ± t standard errors",
    "gls_profile": "profiles under Σ",
    "conditions": "values of Eq. 11, sandwich over conditions",
    "loops": "the same, sandwich over loops",
    "independent": "the same, independent points",
}


def main() -> None:
    study(
        __doc__, "coverage", campaigns=300, first_seed=61_000_000, work=work, program=PROGRAM,
        page=make_page,
    )  # fmt: skip


def work(name: str) -> dict[str, Any]:
    """One campaign by its name: what its intervals say of the truth."""
    return row_of(name, intervals, PROGRAM)


def intervals(seed: int, percent: float) -> Measured:
    """All intervals of one campaign's free parameters, the truth, the laws' error and the time."""
    from sysid.uncertainty.covariance import independent, sandwich
    from sysid.uncertainty.error_model import error_model, errors_at, errors_at_best
    from sysid.uncertainty.profiles import profiles
    from sysid.uncertainty.propagated import by_eq_11, by_gls
    from sysid.uncertainty.sample import observed_of

    trial, fit, design = fitted(seed, percent)
    begin = time.perf_counter()
    observed = observed_of(fit, trial.loops)
    errors = errors_at(fit, observed)
    best = errors_at_best(fit, observed, errors)
    found = {
        "eq_11": by_eq_11(fit, trial.loops, errors),
        "eq_11_straight": by_eq_11(fit, trial.loops, errors, bent=False),
        "gls": by_gls(fit, best),
        "conditions": sandwich(fit),
        "loops": sandwich(fit, "tests"),
        "independent": independent(fit),
    }
    free = fit.coordinates.free
    ends: dict[str, dict[str, Interval]] = {
        kind: {p.symbol: (p.low, p.high, p.identified) for p in e.parameters if p.symbol in free}
        for kind, e in found.items()
    }
    took = time.perf_counter() - begin
    full = error_model(fit, observed, "full", best)
    ends["gls_profile"] = {p.symbol: (p.low, p.high, p.identified) for p in profiles(fit, full)}
    return Measured(ends, {s: trial.truth.parameters[s] for s in free}, design.misfit, took)


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """Shares of every kind of interval, and of every parameter."""
    outcome = Outcome("coverage", "Coverage of the 95 % intervals")
    outcome.say(
        "W11's tests with v_m ≤ 0.4 m/s, 110 loops of 360 points on the virtual rig with its",
        "errors (gain 0.6 %, offset 2 N, delay 0.1 ms, stroke 0.4 %, noise), a damper near W11's",
        "low-range set, fitted with the symmetric variant.  Truth: the generator's parameters,",
        "also where its laws depart smoothly from those of the model.  Only what a kind of",
        "interval calls identified counts; half widths are medians over campaigns of medians over",
        "parameters that all kinds do.",
    )
    for misfit in MISFITS:
        say_shares(outcome, rows, KINDS, misfit)
    took = float(np.median([r["took"] for r in rows]))
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors.  All",
        f"kinds but the profiles under Σ take {took:.1f} s together (median, one thread).",
    )
    outcome.numbers["took_s"] = took
    return outcome


if __name__ == "__main__":
    main()
