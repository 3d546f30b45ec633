"""How long a diagnosis of 110 loops takes when its programs are compiled, and its screen alone.

The limits are wall times on 2 cores, so only a run on an idle machine says anything about them.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from statistics import median
from typing import Any, TypeVar

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import Outcome

from sysid.cli.workers import prepare_to_diagnose
from sysid.data.loops import Loops
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import STANDARD

T = TypeVar("T")
DESIGN = replace(STANDARD, fewest=110, most=110)
HIDDEN: tuple[tuple[str, ...], ...] = (
    (), ("gas_preload",), ("stiff_seal",), ("rod_play",), ("soft_mount",), ("leaking_piston",),
    ("gas_pocket", "vogel_oil"), ("late_sampling", "relaxing_chains"),
)  # fmt: skip
"""What is hidden in each campaign: nothing, one effect (some of them implicit), two."""
PERCENT = 1.0
SEED = 4_000
REPEATS = 8
"""Fits of Σ's sizes, one after the other and in threads."""
DIAGNOSIS_LIMIT, SCREEN_LIMIT = 30.0, 2.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two campaigns, nothing written")
    given = parser.parse_args()
    prepare_to_diagnose()
    rows = []
    for number, names in enumerate(HIDDEN[:2] if given.quick else HIDDEN):
        row = measure(SEED + number, names)
        print(row, file=sys.stderr, flush=True)
        rows.append(row)
    make_page(rows).finish(keep=not given.quick)


def measure(seed: int, names: tuple[str, ...]) -> dict[str, Any]:
    """Diagnose a campaign twice, and score all candidates on its base twice; the second times."""
    from sysid.diagnosis.at_once import at_once
    from sysid.diagnosis.bases import BASES, fit_bases
    from sysid.diagnosis.contenders import score_candidates
    from sysid.diagnosis.diagnose import diagnose_loops
    from sysid.diagnosis.prototypes import prototypes, shape_grid
    from sysid.diagnosis.state import settle
    from sysid.likelihood.reml import fit_sizes

    trial = make_trial(seed, tuple(map(find_planter, names)), (PERCENT,) * len(names), DESIGN)
    loops: Loops = trial.loops
    cold, _ = timed(lambda: diagnose_loops(loops, history=trial.history))
    spent = time.process_time()
    warm, answer = timed(lambda: diagnose_loops(loops, history=trial.history))
    spent = time.process_time() - spent
    history = trial.history
    base = fit_bases(loops, BASES[:1], history=history, seed=0, progress=silent)[0]
    state = settle(base.evidence, base.free.coordinates, base.free.u)
    candidates = prototypes(base.evidence.size, ("loops", "history"))
    score_candidates(base.evidence, state, candidates)
    screen, _ = timed(lambda: score_candidates(base.evidence, state, candidates))

    def sizes(_: int) -> object:
        return fit_sizes(base.evidence.parts, state.gls.residual, state.gls.jacobian)

    alone, _ = timed(lambda: [sizes(k) for k in range(REPEATS)])
    beside, _ = timed(lambda: at_once(sizes, range(REPEATS)))
    shapes = sum(len(shape_grid(c, base.evidence.size)) for c in candidates)
    return {
        "hidden": names, "found": [" / ".join(cause.members) for cause in answer.causes],
        "tests": len(loops.ids), "candidates": len(candidates), "shapes": shapes,
        "cold": cold, "warm": warm, "processor_s": spent, "screen": screen,
        "gain_by_threads": alone / beside,
    }  # fmt: skip


def timed(run: Callable[[], T]) -> tuple[float, T]:
    """Seconds and result."""
    begin = time.perf_counter()
    result = run()
    return time.perf_counter() - begin, result


def silent(_: str) -> None:
    """Nobody listens."""


def make_page(rows: list[dict[str, Any]]) -> Outcome:
    """One row a campaign."""
    page = Outcome("diagnosis_time", "Time of a diagnosis")
    page.say(
        "All steps: bases, Σ, screen, refits, backward check, stability, held-out gain. The first",
        "run includes loading compiled programs (the compile cache may be warm).",
    )
    page.table(
        [
            "hidden", "found", "tests", "candidates (shapes)", "first, s", "warm, s",
            "cores busy", "screen, s",
        ],
        [
            [", ".join(r["hidden"]) or "nothing", ", ".join(r["found"]) or "nothing", r["tests"],
             f"{r['candidates']} ({r['shapes']})", f"{r['cold']:.1f}", f"{r['warm']:.1f}",
             f"{r['processor_s'] / r['warm']:.1f}", f"{r['screen']:.2f}"]
            for r in rows
        ],
    )  # fmt: skip
    warm, screen = ([float(r[k]) for r in rows] for k in ("warm", "screen"))
    page.say(
        f"Warm: median {median(warm):.1f} s, slowest {max(warm):.1f} s",
        f"(limit {DIAGNOSIS_LIMIT:.0f} s). Screen alone: slowest {max(screen):.2f} s",
        f"(limit {SCREEN_LIMIT:.0f} s).",
    )
    slow = max(rows, key=lambda r: float(r["warm"]))
    threads = median(float(r["gain_by_threads"]) for r in rows)
    page.say(
        f"The slowest takes {slow['processor_s']:.0f} s of processor time,",
        f"so {slow['processor_s'] / 2:.0f} s if two cores were busy throughout.",
        "Contenders are fitted side by side in threads; but of",
        f"the sizes of Σ, threads fit {threads:.2f} × as many in the same time (median): they are",
        "many short steps of NumPy and SciPy, which take turns.",
    )
    page.numbers = {"rows": rows, "slowest": max(warm), "screen": max(screen)}
    return page


if __name__ == "__main__":
    main()
