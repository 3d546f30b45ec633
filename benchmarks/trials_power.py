"""How small an effect the diagnosis still finds, against the smallest that anyone could.

In one campaign with a correct base, the size of an effect is raised from the bound in steps of
2^(1/8), and the first size at which the answer contains it (by name, class or family) is found by
bisection.
At the bound an ideal test with known covariance sees it in every second campaign.
"""

import argparse
import os
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from statistics import median
from typing import Any

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import Outcome
from work_file import FOLDER, add_row, read_rows

from sysid.cli.workers import prepare_to_diagnose
from sysid.errors import DataError, SysidError
from sysid.identification.fit import fit_loops
from sysid.rig.planters.planter import Planter
from sysid.rig.planters.registry import CATALOGUE, find_planter
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import STANDARD
from sysid.trials.misfit import BASE
from sysid.trials.score import RIGHT, given_by, score
from sysid.trials.visible import DETECTED, visibilities

WORK = FOLDER / "trials_power.jsonl"
FIRST_SEED = 77_000
EVERY_SECOND = DETECTED - 0.84
"""d′ at which one of 31 candidates is seen in half of the campaigns at α = .01."""
STEPS = 31
"""Sizes tried at most: bound × 2^(k/8), k = 0 … STEPS − 1."""
STEP = 2.0**0.125
LEAST = 1e-3
"""Smallest size that is looked at, % of the RMS force."""
FOUND = (*RIGHT, "right_family")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--every", type=int, default=1, help="only every n-th planter")
    parser.add_argument("--processes", type=int, default=2, help="effects at once")
    parser.add_argument("--quick", action="store_true", help="one planter, nothing written")
    parser.add_argument("--page", action="store_true", help="make the page of what is done")
    given = parser.parse_args()
    planters = CATALOGUE[:: given.every][: 1 if given.quick else None]
    file = WORK.with_suffix(".quick.jsonl") if given.quick else WORK
    done = {row["planter"]: row for row in read_rows(file)}
    missing = [] if given.page else [p for p in planters if p.name not in done]
    with ProcessPoolExecutor(
        given.processes, get_context("spawn"), initializer=prepare_to_diagnose
    ) as pool:
        running = [pool.submit(search, p.name, FIRST_SEED + CATALOGUE.index(p)) for p in missing]
        for future in as_completed(running):
            row = future.result()
            add_row(row, file)
            done[row["planter"]] = row
            print(f"{len(done)}/{len(planters)} {row}", file=sys.stderr, flush=True)
    rows = [done[p.name] for p in planters if p.name in done]
    make_page(rows).finish(keep=not given.quick)


def search(name: str, seed: int) -> dict[str, Any]:
    """The smallest size that is found, by bisection over the steps."""
    planter = find_planter(name)
    bound = smallest(planter, seed)
    low, high = -1, STEPS
    while high - low > 1:
        middle = (low + high) // 2
        if is_found(planter, seed, bound * STEP**middle):
            high = middle
        else:
            low = middle
    reached = bound * STEP**high if high < STEPS else None
    allowed = None if reached is None else with_structure(planter, seed, reached)
    return {"planter": planter.name, "seed": seed, "bound": bound, "reached": reached,
            "distance": allowed}  # fmt: skip


def smallest(planter: Planter, seed: int) -> float:
    """The size at the bound, % of the RMS force.

    Searched for: what a small gap or a small delay changes on the points that are recorded is not
    in proportion to its size.
    """
    base = fit_loops(make_trial(seed, (), (), STANDARD).loops, variant=BASE)
    low, high = LEAST, 1.0
    while high / low > 1.05:
        middle = (low * high) ** 0.5
        try:
            trial = make_trial(seed, (planter,), (middle,), STANDARD)
            seen = visibilities(trial, seed, STANDARD, base)[0].distance
        except DataError:
            seen = 0.0
        low, high = (low, middle) if seen >= EVERY_SECOND else (middle, high)
    return high


def with_structure(planter: Planter, seed: int, percent: float) -> float:
    """d′ of the planted force under the Σ that is estimated: the laws may err."""
    from sysid.diagnosis.absorbed import products
    from sysid.diagnosis.bases import BASES, fit_bases
    from sysid.diagnosis.state import settle

    trial = make_trial(seed, (planter,), (percent,), STANDARD)
    base = fit_bases(
        trial.loops, BASES[:1], history=trial.history, seed=0, progress=lambda _: None
    )[0]
    state = settle(base.evidence, base.free.coordinates, base.free.u)
    added = base.evidence.basis.compress(trial.truth.force - trial.truth.force_without)
    _, left = products(added[:, :, None], state.gls.jacobian, state.covariance)
    return float(max(left[0, 0], 0.0)) ** 0.5


def is_found(planter: Planter, seed: int, percent: float) -> bool:
    """The answer contains the planted effect."""
    from sysid.diagnosis.diagnose import diagnose_loops

    try:
        trial = make_trial(seed, (find_planter(planter.name),), (percent,), STANDARD)
        answer = diagnose_loops(trial.loops, history=trial.history, seed=seed)
    except SysidError:
        return False
    return score(given_by(answer), trial.truth).found[0] in FOUND


def make_page(rows: list[dict[str, Any]]) -> Outcome:
    """One row an effect."""
    page = Outcome("trials_power", "The smallest effects that are found")
    shares = [r["bound"] / r["reached"] if r["reached"] else 0.0 for r in rows]
    page.say(
        "Correct base, one campaign an effect. Bound: the size that an ideal test with known",
        "covariance sees in every second campaign. Found: the first of the sizes bound × 2^(k/8)",
        "at which the answer contains the effect. Efficiency: bound over found. Errors of the",
        "laws not excluded: d′ of the effect as found under the Σ that is estimated without it,",
        f"and the part that {EVERY_SECOND:.2f} is of it: the efficiency against a bound that does",
        "not know beforehand that the laws are right.",
    )
    apart = [EVERY_SECOND / r["distance"] if r["reached"] else 0.0 for r in rows]
    page.table(
        ["planter", "bound, % of RMS force", "found at, %", "efficiency", "d′, laws not excluded",
         "efficiency"],
        [
            [r["planter"], f"{r['bound']:.3f}", f"{r['reached']:.3f}" if r["reached"] else
             f"not up to {r['bound'] * STEP ** (STEPS - 1):.3f}", f"{share:.2f}",
             f"{r['distance']:.1f}" if r["reached"] else "", f"{min(one, 1.0):.2f}"]
            for r, share, one in zip(rows, shares, apart, strict=True)
        ],
    )  # fmt: skip
    middle, other = (median(z) if z else float("nan") for z in (shares, apart))
    page.say(
        f"Median efficiency {middle:.2f} over {len(rows)} effects (target .8); where errors of the",
        f"laws are not excluded {min(other, 1.0):.2f}.",
    )
    page.numbers = {"rows": rows, "median": middle, "median_laws_not_excluded": min(other, 1.0)}
    return page


if __name__ == "__main__":
    main()
