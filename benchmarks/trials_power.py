"""How small an effect the diagnosis still finds, against the smallest that anyone could.

In one campaign with a correct base, the size of an effect is raised from the bound in steps of
2^(1/4), and the first size at which the answer contains it (by name, class or family) is found by
bisection.
At the bound an ideal test with known covariance sees it in every second campaign.
"""

import argparse
import json
import os
import sys
from pathlib import Path
from statistics import median
from typing import Any

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import Outcome
from trials import prepare_worker

from sysid.errors import SysidError
from sysid.identification.fit import fit_loops
from sysid.rig.planters.planter import Planter
from sysid.rig.planters.registry import CATALOGUE, find_planter
from sysid.rig.trial_campaign import STANDARD, make_trial
from sysid.trials.misfit import BASE
from sysid.trials.score import RIGHT, given_by, score
from sysid.trials.visible import DETECTED, visibilities

WORK = Path(__file__).parents[1] / "build" / "trials_power.jsonl"
FIRST_SEED = 77_000
EVERY_SECOND = DETECTED - 0.84
"""d′ at which one of 31 candidates is seen in half of the campaigns at α = .01."""
STEPS = 15
"""Sizes tried at most: bound × 2^(k/4), k = 0 … STEPS − 1."""
STEP = 2.0**0.25
FOUND = (*RIGHT, "right_family")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--every", type=int, default=2, help="only every n-th planter")
    parser.add_argument("--quick", action="store_true", help="one planter, nothing written")
    parser.add_argument("--page", action="store_true", help="make the page of what is done")
    given = parser.parse_args()
    prepare_worker()
    planters = CATALOGUE[:: given.every][: 1 if given.quick else None]
    file = WORK.with_suffix(".quick.jsonl") if given.quick else WORK
    done = {row["planter"]: row for row in finished(file)}
    for number, planter in enumerate(planters):
        if planter.name not in done and not given.page:
            row = search(planter, FIRST_SEED + number)
            keep(row, file)
            done[planter.name] = row
            print(f"{number + 1}/{len(planters)} {row}", file=sys.stderr, flush=True)
    rows = [done[p.name] for p in planters if p.name in done]
    make_page(rows).finish(keep=not given.quick)


def finished(file: Path) -> list[dict[str, Any]]:
    if not file.exists():
        return []
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line]


def keep(row: dict[str, Any], file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a", encoding="utf-8") as out:
        out.write(json.dumps(row) + "\n")


def search(planter: Planter, seed: int) -> dict[str, Any]:
    """The smallest size that is found, by bisection over the steps."""
    known = make_trial(seed, (planter,), (1.0,), STANDARD)
    base = fit_loops(known.loops, variant=BASE)
    distance = visibilities(known, seed, STANDARD, base)[0].distance
    bound = EVERY_SECOND / distance
    low, high = -1, STEPS
    while high - low > 1:
        middle = (low + high) // 2
        if is_found(planter, seed, bound * STEP**middle):
            high = middle
        else:
            low = middle
    reached = bound * STEP**high if high < STEPS else None
    return {"planter": planter.name, "seed": seed, "bound": bound, "reached": reached}


def is_found(planter: Planter, seed: int, percent: float) -> bool:
    """The answer contains the planted effect."""
    from sysid.diagnosis.diagnose import diagnose_loops

    try:
        trial = make_trial(seed, (find_planter(planter.name),), (percent,), STANDARD)
        answer = diagnose_loops(trial.loops, run_order=trial.run_order, seed=seed)
    except SysidError:
        return False
    return score(given_by(answer), trial.truth).found[0] in FOUND


def make_page(rows: list[dict[str, Any]]) -> Outcome:
    """One row an effect."""
    page = Outcome("trials_power", "The smallest effects that are found")
    shares = [r["bound"] / r["reached"] if r["reached"] else 0.0 for r in rows]
    page.say(
        "Correct base, one campaign an effect. Bound: the size that an ideal test with known",
        "covariance sees in every second campaign. Found: the first of the sizes bound × 2^(k/4)",
        "at which the answer contains the effect. Efficiency: bound over found.",
    )
    page.table(
        ["planter", "bound, % of RMS force", "found at, %", "efficiency"],
        [
            [r["planter"], f"{r['bound']:.3f}", f"{r['reached']:.3f}" if r["reached"] else
             f"not up to {r['bound'] * STEP ** (STEPS - 1):.3f}", f"{share:.2f}"]
            for r, share in zip(rows, shares, strict=True)
        ],
    )  # fmt: skip
    middle = median(shares) if shares else float("nan")
    page.say(f"Median efficiency {middle:.2f} over {len(rows)} effects (target .8).")
    page.numbers = {"rows": rows, "median": middle}
    return page


if __name__ == "__main__":
    main()
