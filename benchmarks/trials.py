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
import traceback
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import RESULTS, Outcome
from program import fingerprint
from proportions import Share
from work_file import FOLDER, finished, keep, put_aside, shortened

from sysid.cli.compile_cache import cache_folder
from sysid.errors import DataError, SysidError
from sysid.trials.regimes import REGIMES, TrialSpec, plan

if TYPE_CHECKING:
    import numpy as np

    from sysid.data.loops import Loops
    from sysid.diagnosis.result import Diagnosis
    from sysid.trials.outcome import Row

WORK = RESULTS / "trials.jsonl"
PROGRAM = (
    "arrays.py", "data", "diagnosis", "effects", "identification", "likelihood", "models", "motion",
    "parameters.py", "rig", "trials/misfit.py", "trials/outcome.py", "trials/quantities.py",
    "trials/regimes.py", "trials/score.py", "trials/visible.py", "units.py",
)  # fmt: skip
"""What of the package a trial depends on, but for `NOT_THAT`."""
NOT_THAT = ("rig/physical",)

COUNTS = {
    "none": 100, "none_misfit": 100, "one": 104, "one_misfit": 104, "outside": 55, "two": 60,
    "bouc_wen": 40, "invisible": 12, "history": 15,
}  # fmt: skip
"""Trials of the full study."""
SLICE = {
    "none": 2, "none_misfit": 2, "one": 4, "one_misfit": 2, "outside": 2, "two": 1, "bouc_wen": 1,
}  # fmt: skip
"""Trials of `--slice`."""
FIRST_SEED = {regime.name: 10_000 * (k + 1) for k, regime in enumerate(REGIMES)}


def main() -> None:
    given = arguments()
    counts = SLICE if given.slice else COUNTS
    regimes = given.regime or list(counts)
    specs = in_turn([plan(name, given.count or counts[name], FIRST_SEED[name]) for name in regimes])
    file: Path = given.file
    program = fingerprint(PROGRAM, NOT_THAT)
    if not given.page:
        put_aside(file, program, FOLDER / "trials_aside.jsonl")
    done = {key(row["regime"], row["seed"]): row for row in finished(file)}
    missing = [spec for spec in specs if key(spec.regime, spec.seed) not in done]
    if given.page:
        missing = []
    commit, begin = version(), time.perf_counter()
    for n, row in enumerate(run_all(missing, given.processes), 1):
        row = shortened(row) | {"commit": commit, "program": program}
        keep(row, file)
        done[key(row["regime"], row["seed"])] = row
        tell(n, len(missing), row, time.perf_counter() - begin)
    rows = [done[key(s.regime, s.seed)] for s in specs if key(s.regime, s.seed) in done]
    partial = given.slice or given.regime or given.count
    make_page(rows).finish(keep=given.page or not partial)


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


def in_turn(plans: Sequence[Sequence[TrialSpec]]) -> list[TrialSpec]:
    """All trials, regimes mixed in proportion: a study that is stopped early is one of them all."""
    placed = [((k + 0.5) / len(one), n, spec) for n, one in enumerate(plans)
              for k, spec in enumerate(one)]  # fmt: skip
    return [spec for _, _, spec in sorted(placed, key=lambda p: p[:2])]


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


def diagnose_or_fail(loops: "Loops", *, run_order: "np.ndarray | None", seed: int) -> "Diagnosis":
    """A crash is no answer: it counts as one that names nothing, and does not end the study."""
    from sysid.diagnosis.diagnose import diagnose_loops

    try:
        return diagnose_loops(loops, run_order=run_order, seed=seed)
    except SysidError:
        raise
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        raise DataError(f"crashed in {place.name}, line {place.lineno}: {error!r}") from error


def run_one(spec: TrialSpec) -> dict[str, Any]:
    """One trial, in a worker; the baseline beside it where the base is a W11 model."""
    from trials_baseline import sparse_names

    from sysid.trials.outcome import run_trial

    return run_trial(spec, diagnose_or_fail, sparse_names).as_dict()


def tell(n: int, of: int, row: dict[str, Any], seconds: float) -> None:
    """One line of progress."""
    score = row["score"] or {"judged": []}
    names = ", ".join(
        f"{'/'.join(j['given']['members']) or j['given']['family']} ({j['verdict']})"
        for j in score["judged"]
    )
    hidden = ", ".join(row["planters"]) or "nothing"
    answer = row["failure"] or names or row["answer"]
    print(
        f"{n}/{of} {row['regime']} {row['seed']} hidden: {hidden}; answer: {answer}; "
        f"{row['seconds']:.0f} s ({seconds:.0f} s in all)",
        file=sys.stderr,
        flush=True,
    )


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """The study as a page."""
    from sysid.trials.outcome import Row, read_row
    from sysid.trials.summary import confusions

    fields = Row.__dataclass_fields__
    trials = [read_row({k: v for k, v in row.items() if k in fields}) for row in rows]
    page = Outcome("trials", "Blind trials")
    commits = Counter(row["commit"] for row in rows)
    program = ", ".join(f"{name} ({n} trials)" for name, n in commits.most_common())
    page.numbers = {"commits": dict(commits), "trials": len(trials)}
    page.say(
        f"{len(trials)} campaigns of 60 to 110 loops, program {program}.",
        "Rates are hits/trials = share, with Wilson's 95 % interval.",
        "The baseline is sparse regression of what the fitted base leaves, scored by the same",
        "rules. Visible: the bound on naming is at least 95 % in that campaign; the others apart.",
    )
    add_rates(page, trials)
    add_figures(page, trials)
    confused = confusions(trials)
    page.say("What was hidden, and what was answered:")
    page.table(["hidden", "answer", "trials"], confused)
    page.numbers["confusions"] = confused
    failed = [(r.regime, r.seed, ", ".join(r.planters), r.failure) for r in trials if r.failure]
    if failed:
        page.say(f"{len(failed)} trials gave no result:")
        page.table(["regime", "seed", "hidden", "why"], failed)
    page.numbers["failures"] = failed
    return page


def add_rates(page: Outcome, trials: "Sequence[Row]") -> None:
    """The table of rates, the baseline beside the diagnosis."""
    from sysid.trials.summary import baseline, ours, rates

    theirs = {(r.regime, r.what): r.count for r in rates(trials, baseline)}
    table, numbers = [], []
    for rate in rates(trials, ours):
        other = theirs.get((rate.regime, rate.what))
        share = Share(rate.count.hits, rate.count.trials)
        beside = None if other is None else Share(other.hits, other.trials)
        table.append([rate.regime, rate.what, rate.target, share, beside or ""])
        numbers.append(
            {"regime": rate.regime, "what": rate.what, "target": rate.target}
            | {"diagnosis": share.as_dict(), "baseline": beside and beside.as_dict()}
        )
    page.table(["regime", "counted", "target", "diagnosis", "baseline"], table)
    page.numbers["rates"] = numbers


def add_figures(page: Outcome, trials: "Sequence[Row]") -> None:
    """Sizes, gains and times."""
    from sysid.trials.summary import gain_ratio, sizes

    rows: list[list[object]] = []
    recovered, gain = sizes(trials), gain_ratio(trials)
    if recovered is not None:
        covered = Share(recovered.covered.hits, recovered.covered.trials)
        rows += [
            ["bias of sizes (median)", "≤ 10 %", f"{100 * recovered.bias:.1f} %"],
            ["largest bias of one parameter", "", f"{100 * recovered.worst:.1f} %"],
            ["95 % intervals cover", "90 to 98 %", covered],
            ["RMS force added / planted (median)", "", f"{recovered.force:.2f}"],
        ]
        page.numbers["sizes"] = asdict(recovered)
    if gain is not None:
        shown = f"{gain[0]:.2f}; {gain[1]:.2f}; {gain[2]}"
        rows.append(["achieved / oracle gain (of sums; median; trials)", "≥ .9", shown])
        page.numbers["gain"] = {"of_sums": gain[0], "median": gain[1], "trials": gain[2]}
    took = sorted(row.seconds for row in trials if row.score is not None)
    if took:
        shown = f"{took[len(took) // 2]:.0f}; {took[-1]:.0f}"
        rows.append(["seconds a diagnosis, others running (median; longest)", "", shown])
    page.table(["figure", "target", "reached"], rows)


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
