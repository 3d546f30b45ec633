"""What blind trials could show at best: the naming bound for every planter of the catalogue."""

import argparse
import os
from collections import Counter
from dataclasses import replace
from statistics import median

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import Outcome

from sysid.cli.workers import prepare_to_diagnose
from sysid.errors import DataError
from sysid.identification.fit import fit_loops
from sysid.rig.planters.planter import Planter
from sysid.rig.planters.registry import CATALOGUE
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import STANDARD
from sysid.trials.misfit import BASE, misfit_of
from sysid.trials.visible import Visibility, visibilities

CASES = ((1.0, 0.0), (2.0, 2.0), (2.0, 5.0))
"""Size of the effect and structural misfit, % of the RMS force."""
FIRST_SEED = 500


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=3)
    parser.add_argument("--quick", action="store_true", help="1 campaign, nothing written")
    given = parser.parse_args()
    prepare_to_diagnose()
    seeds = range(FIRST_SEED, FIRST_SEED + (1 if given.quick else given.campaigns))
    found: dict[tuple[str, float, float], list[Visibility]] = {}
    for seed in seeds:
        for percent, misfit in CASES:
            for planter in CATALOGUE:
                seen = bound(seed, planter, percent, misfit)
                if seen is not None:
                    found.setdefault((planter.name, percent, misfit), []).append(seen)
    make_page(found, len(seeds)).finish(keep=not given.quick)


def bound(seed: int, planter: Planter, percent: float, misfit: float) -> Visibility | None:
    """The bound in one campaign; None where the effect cannot be made so large."""
    wrong = misfit_of(seed, misfit, STANDARD)
    design = replace(STANDARD, misfit=wrong.size)
    try:
        trial = make_trial(seed, (planter,), (percent,), design)
    except DataError:
        return None
    base = fit_loops(trial.loops, variant=BASE)
    return visibilities(trial, seed, design, base, wrong.left if misfit else None)[0]


def make_page(found: dict[tuple[str, float, float], list[Visibility]], seeds: int) -> Outcome:
    """One row a planter, three cells a case."""
    page = Outcome("trials_bound", "What blind trials could show at best")
    page.say(
        f"{seeds} campaigns. A cell: campaigns in which the effect is visible (detectable and",
        "told from its nearest rival with 95 %, `sysid/trials/visible.py`); median d′; median",
        "|cos| with the catalogue's own effect, and with the rival that is nearest most often.",
        "Where the planter looks more like a rival than like its own effect (marked !), the bound",
        "is no promise: it knows the planted force, the catalogue does not.",
    )
    rows = []
    for planter in CATALOGUE:
        cells = [cell(found.get((planter.name, *case), [])) for case in CASES]
        rows.append([planter.name, planter.causes[0], *cells])
    heads = [f"{percent:g} %, misfit {misfit:g} %" for percent, misfit in CASES]
    page.table(["planter", "cause", *heads], rows)
    page.numbers = {
        "bounds": [
            {"planter": name, "percent": percent, "misfit": misfit} | vars(seen)
            for (name, percent, misfit), every in found.items()
            for seen in every
        ]
    }
    return page


def cell(every: list[Visibility]) -> str:
    if not every:
        return "cannot be made so large"
    own, rival = (median(z) for z in ([v.own for v in every], [v.likeness for v in every]))
    name = Counter(v.rival for v in every).most_common(1)[0][0]
    mark = "" if abs(own) > rival else " !"
    visible = sum(v.visible for v in every)
    distance = median(v.distance for v in every)
    return f"{visible}/{len(every)}, d′ {distance:.0f}, own {own:.2f}, {name} {rival:.2f}{mark}"


if __name__ == "__main__":
    main()
