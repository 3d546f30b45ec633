"""How often 95 % intervals of fitted parameters contain the truth, for each kind of interval.

Every finished campaign is one line of a work file, so that a study goes on where it was.
"""

import os
import sys
import time
from collections.abc import Sequence
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from interval_rows import BAND, HOLDS, OPEN, Interval, Told, told
from outcome import RESULTS, Outcome
from study import run_study, study_parser
from work_file import FOLDER, read_rows

from sysid.jobs.job import Ended
from sysid.jobs.rows import shortened
from sysid.trials.program import fingerprint

MISFITS: Final = (0.0, 2.0)
"""RMS that the refitted model leaves of a perfect measurement, % of the RMS force."""
CAMPAIGNS: Final = 300
"""Of each misfit."""
FIRST_SEED: Final = 61_000_000
WORK: Final = RESULTS / "coverage.jsonl"
PROGRAM: Final = fingerprint(
    ("arrays.py", "data", "effects", "identification", "likelihood", "models", "motion",
     "parameters.py", "rig", "trials/misfit.py", "uncertainty", "units.py"), ("rig/physical",),
)  # fmt: skip
"""Rows count for the program that fitted and told the intervals."""
CARD: Final = "eq_11"
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
    parser = study_parser(__doc__ or "", "one campaign of each misfit")
    parser.add_argument("--campaigns", type=int, default=CAMPAIGNS, help="of each misfit")
    given = parser.parse_args()
    file = FOLDER / "coverage.quick.jsonl" if given.quick else WORK
    seeds = range(FIRST_SEED, FIRST_SEED + (1 if given.quick else given.campaigns))
    names = [f"{misfit:g}:{seed}" for seed in seeds for misfit in MISFITS]
    if not given.page:
        run_study(names, work, file, PROGRAM, processes=given.processes, words=words)
    rows = [row for row in read_rows(file) if row["id"] in set(names)]
    if not rows:
        sys.exit(f"No campaign is finished in {file}: run this without --page")
    make_page(rows).finish(keep=not given.quick)


def work(name: str) -> dict[str, Any]:
    """One campaign by its name: what its intervals say of the truth."""
    misfit, seed = name.split(":")
    found, truth, size, took = intervals(int(seed), float(misfit))
    return {"id": name, "misfit": float(misfit), **told(found, truth),
            **shortened({"size": size, "took": took}, 3), "program": PROGRAM}  # fmt: skip


def intervals(
    seed: int, percent: float
) -> tuple[dict[str, dict[str, Interval]], dict[str, float], float, float]:
    """All intervals of one campaign's free parameters, the truth, the laws' error and the time."""
    from sysid.identification.fit import fit_loops
    from sysid.rig.trial_campaign import TrialDesign, make_trial
    from sysid.trials.misfit import misfit_of
    from sysid.uncertainty.covariance import independent, sandwich
    from sysid.uncertainty.error_model import errors_at
    from sysid.uncertainty.profiles import profiles
    from sysid.uncertainty.propagated import by_eq_11, by_gls
    from sysid.uncertainty.sample import observed_of

    design = TrialDesign(fewest=110, most=110)
    size = misfit_of(seed, percent, design).size
    trial = make_trial(seed, design=TrialDesign(fewest=110, most=110, misfit=size))
    fit = fit_loops(trial.loops, variant="symmetric")
    begin = time.perf_counter()
    errors = errors_at(fit, observed_of(fit, trial.loops))
    found = {
        "eq_11": by_eq_11(fit, trial.loops, errors),
        "eq_11_straight": by_eq_11(fit, trial.loops, errors, bent=False),
        "gls": by_gls(fit, errors),
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
    ends["gls_profile"] = {p.symbol: (p.low, p.high, p.determined) for p in profiles(fit, errors)}
    return ends, {s: trial.truth.parameters[s] for s in free}, size, took


def words(ended: Ended) -> str:
    """How the card's intervals did, in a few words."""
    signs = (ended.row or {})["holds"][CARD]
    return f"{signs.count(HOLDS)} of {len(signs) - signs.count(OPEN)} intervals hold the truth"


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
        here = [r for r in rows if r["misfit"] == misfit]
        if not here:
            continue
        table, numbers = [], {}
        for kind, words in KINDS.items():
            told = Told(here, kind)
            share, low, high = told.pooled()
            outside = told.outside()
            shown = ", ".join(f"{s} {h}/{n}" for s, (h, n) in sorted(outside.items())) or "none"
            count = sum(n for _, n in told.campaigns)
            table.append((words, f"{share:.1%} ({low:.1%} to {high:.1%})", count,
                          f"± {told.half:.2%}", shown))  # fmt: skip
            numbers[kind] = {
                "share": share, "low": low, "high": high, "intervals": count, "half": told.half,
                "outside": outside,
                "by_symbol": {s: [sum(z), len(z)] for s, z in sorted(told.hits.items())},
            }  # fmt: skip
        sizes = [r["size"] for r in here]
        laws = f", laws wrong by {np.mean(sizes):.1%} (RMS)" if misfit else ", laws right"
        outcome.say(f"## The refitted model leaves {misfit:g} %{laws}: {len(here)} campaigns")
        outcome.table(
            ("interval", "holds the truth (aim 92–98 %)", "intervals", "half width",
             f"parameters outside the {BAND:.1%} binomial band of 95 %"), table,
        )  # fmt: skip
        own = numbers[CARD]["by_symbol"]
        outcome.table(
            ("the card's, parameter", *own),
            [("holds the truth", *(f"{h}/{n}" for h, n in own.values()))],
        )
        outcome.numbers[f"misfit_{misfit:g}"] = {"campaigns": len(here), **numbers}
    took = float(np.median([r["took"] for r in rows]))
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors.  All",
        f"kinds but the profiles under Σ take {took:.1f} s together (median, one thread).",
    )
    outcome.numbers["took_s"] = took
    return outcome


if __name__ == "__main__":
    main()
