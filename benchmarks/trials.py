"""Blind trials: effects are hidden, diagnosed and scored; rates beside their targets.

Every finished trial is one line of a work file, which stays with the results: a run that was
stopped goes on where it was, weeks later too. Lines count for the program that made them only;
those of another one are put aside. The page is made of all lines that belong to the plan.
"""

import argparse
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from typing import Any

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import RESULTS, Outcome
from work_file import FOLDER, finished, keep, put_aside, shortened

from sysid.cli.compile_cache import cache_folder
from sysid.trials.one import diagnose_or_fail, row_of
from sysid.trials.outcome import run_trial
from sysid.trials.page import answer_words, page_of, result_of
from sysid.trials.plan import Group, Plan
from sysid.trials.program import program
from sysid.trials.regimes import REGIMES, TrialSpec
from sysid.trials.sparse_regression import sparse_names
from sysid.trials.trial_id import spec_of

WORK = RESULTS / "trials.jsonl"
COUNTS = {
    "none": 100, "none_misfit": 100, "one": 104, "one_misfit": 104, "outside": 55, "two": 60,
    "bouc_wen": 40, "invisible": 12, "history": 15,
}  # fmt: skip
"""Trials of the full study on the hysteretic damper."""
SLICE = {
    "none": 2, "none_misfit": 2, "one": 4, "one_misfit": 2, "outside": 2, "two": 1, "bouc_wen": 1,
}  # fmt: skip
"""Trials of `--slice`."""


def main() -> None:
    given = arguments()
    counts = SLICE if given.slice else COUNTS
    regimes = given.regime or list(counts)
    groups = [Group(regime=name, count=given.count or counts[name]) for name in regimes]
    specs = [spec_of(trial) for trial in Plan(tuple(groups)).trials()]
    file: Path = given.file
    mine = program(physical=False)
    if not given.page:
        put_aside(file, mine, FOLDER / "trials_aside.jsonl")
    done = {key(row["regime"], row["seed"]): row for row in finished(file)}
    missing = [spec for spec in specs if key(spec.regime, spec.seed) not in done]
    if given.page:
        missing = []
    commit, begin = version(), time.perf_counter()
    for n, row in enumerate(run_all(missing, given.processes), 1):
        row = shortened(row) | {"commit": commit, "program": mine}
        keep(row, file)
        done[key(row["regime"], row["seed"])] = row
        tell(n, len(missing), row, time.perf_counter() - begin)
    rows = [done[key(s.regime, s.seed)] for s in specs if key(s.regime, s.seed) in done]
    partial = given.slice or given.regime or given.count
    make_page(rows, len(specs) - len(rows)).finish(keep=given.page or not partial)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--regime", action="append", choices=[r.name for r in REGIMES])
    parser.add_argument("--count", type=int, help="trials of each regime")
    parser.add_argument("--page", action="store_true", help="make the page of what is done")
    parser.add_argument("--slice", action="store_true", help="a few trials, no page written")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument(
        "--file", type=Path, default=WORK, help="where finished trials are kept, one a line"
    )
    return parser.parse_args()


def key(regime: str, seed: int) -> tuple[str, int]:
    return regime, seed


def run_all(specs: Sequence[TrialSpec], processes: int) -> Iterator[dict[str, Any]]:
    """Results as they come."""
    if processes <= 1 or len(specs) <= 1:
        prepare_worker()
        yield from map(run_one, specs)
        return
    left = {key(spec.regime, spec.seed): spec for spec in specs}
    while left:
        before = len(left)
        try:
            for row in _with_workers(list(left.values()), processes):
                del left[key(row["regime"], row["seed"])]
                yield row
        except BrokenProcessPool:
            if len(left) == before:
                raise
            print("a worker died; the rest goes on with new ones", flush=True)


def _with_workers(specs: Sequence[TrialSpec], processes: int) -> Iterator[dict[str, Any]]:
    # a fresh interpreter each: JAX does not survive a fork
    context = get_context("spawn")
    with ProcessPoolExecutor(processes, context, initializer=prepare_worker) as pool:
        for future in as_completed([pool.submit(run_one, spec) for spec in specs]):
            yield future.result()


def prepare_worker() -> None:
    """Compiled programs are shared between processes and runs."""
    import jax

    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    jax.config.update("jax_compilation_cache_dir", str(folder))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)


def run_one(spec: TrialSpec) -> dict[str, Any]:
    """One trial, in a worker; the baseline beside it where the base is a W11 model."""
    return run_trial(spec, diagnose_or_fail, sparse_names).as_dict()


def tell(n: int, of: int, values: dict[str, Any], seconds: float) -> None:
    """One line of progress."""
    row = row_of(values)
    hidden = ", ".join(row.planters) or "nothing"
    print(
        f"{n}/{of} {row.regime} {row.seed} hidden: {hidden}; answer: {answer_words(row)}; "
        f"{row.seconds:.0f} s ({seconds:.0f} s in all)",
        file=sys.stderr,
        flush=True,
    )


def make_page(rows: Sequence[dict[str, Any]], missing: int) -> Outcome:
    """The study as a page, as `sysid trials` makes it."""
    page = Outcome("trials", "Blind trials")
    made = page_of([result_of(row) for row in rows], missing, {})
    commits = Counter(row["commit"] for row in rows)
    page.lines = [made.text.partition("\n")[2].strip("\n")]
    page.say("Commits:", ", ".join(f"{name} ({n} trials)" for name, n in commits.most_common()))
    page.numbers = made.numbers | {"commits": dict(commits)}
    return page


def version() -> str:
    """Commit of the program."""
    folder = Path(__file__).parent
    asked = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=folder, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    return asked.stdout.strip() or "of no known commit"


if __name__ == "__main__":
    main()
