"""How long a diagnosis takes whose programs have yet to be compiled, as a user's first one.

Each runs in a process of its own.  The second campaign has another number of tests and finds what
the first one left in the compile cache.  Ratios are of one run, on an otherwise idle machine.
"""

import argparse
import os
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from typing import Final

from outcome import Outcome

SEED: Final = 4_003
HIDDEN: Final = "rod_play"
PERCENT: Final = 1.0
FIRST, SECOND = 110, 75
"""Tests of the two campaigns."""
EMITTERS: Final = "--xla_cpu_use_fusion_emitters=true"
"""As JAX compiles by itself."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="the shipped way only, not written")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as plain, tempfile.TemporaryDirectory() as kept:
        seconds = {} if given.quick else {"as JAX does": alone(FIRST, plain, EMITTERS)}
        seconds["empty cache"] = alone(FIRST, kept)
        seconds["another number of tests"] = alone(SECOND, kept)
        seconds["the first again"] = alone(FIRST, kept)
    make_page(seconds).finish(keep=not given.quick)


def alone(tests: int, cache: str, flags: str = "") -> float:
    """Seconds of a diagnosis in a new process.

    Args:
        tests: How many.
        cache: Folder of compiled programs.
        flags: Of XLA.
    """
    with ProcessPoolExecutor(1, get_context("spawn")) as one:
        return one.submit(diagnosed, tests, cache, flags).result()


def diagnosed(tests: int, cache: str, flags: str) -> float:
    """Seconds of a diagnosis in this process."""
    os.environ |= {"XDG_CACHE_HOME": cache, "XLA_FLAGS": flags, "OPENBLAS_NUM_THREADS": "1"}
    from sysid.cli.workers import prepare_to_diagnose

    prepare_to_diagnose()
    from sysid.diagnosis.diagnose import diagnose_loops
    from sysid.rig.planters.registry import find_planter
    from sysid.rig.trial_campaign import make_trial
    from sysid.rig.trial_design import STANDARD

    design = replace(STANDARD, fewest=tests, most=tests)
    trial = make_trial(SEED, (find_planter(HIDDEN),), (PERCENT,), design)
    begin = time.perf_counter()
    diagnose_loops(trial.loops, history=trial.history)
    return time.perf_counter() - begin


def make_page(seconds: dict[str, float]) -> Outcome:
    """One row a run."""
    page = Outcome("first_diagnosis", "Time of a first diagnosis")
    page.say(
        f"Virtual campaigns with {HIDDEN} of {PERCENT:g} %. First a campaign of {FIRST} tests with "
        "nothing compiled, compiled as JAX does by itself and as `sysid diagnose` has it; then, "
        f"with what that left in the compile cache, one of {SECOND} tests, and the first again."
    )
    last = seconds["the first again"]
    page.table(
        ["diagnosis in a new process", "s", "over the last"],
        [[name, f"{value:.0f}", f"{value / last:.1f}"] for name, value in seconds.items()],
    )
    page.numbers = seconds
    return page


if __name__ == "__main__":
    main()
