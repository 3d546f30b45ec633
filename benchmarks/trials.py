"""Blind trials: effects are hidden, diagnosed and scored; rates beside their targets.

What `sysid trials` does, with results that stay with the others: every finished trial is one line
of a work file, so that a study goes on where it was, weeks later too.  Lines count for the program
that made them only; those of another one are put aside.  The page is made of all lines that belong
to the plan.
"""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import RESULTS, Outcome
from study import run_study
from work_file import FOLDER, read_rows

from sysid.cli.soundness import unfit
from sysid.cli.trials import words
from sysid.trials.one import id_of, work_of
from sysid.trials.page import page_of, result_of
from sysid.trials.plan import COUNTS as FULL
from sysid.trials.plan import Group, Plan
from sysid.trials.program import program
from sysid.trials.regimes import REGIMES
from sysid.trials.trial_id import PHYSICAL

WORK = RESULTS / "trials.jsonl"
COUNTS = {name: count for name, count in FULL.items() if name != PHYSICAL}
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
    names = [str(trial) for trial in Plan(tuple(groups)).trials()]
    file: Path = given.file or (FOLDER / "trials_slice.jsonl" if given.slice else WORK)
    failures = {} if given.page else run(names, file, given.processes)
    done = {name: row for row in read_rows(file) if (name := id_of(row)) in set(names)}
    rows = [done[name] for name in names if name in done]
    partial = given.slice or given.regime or given.count
    make_page(rows, len(names) - len(rows), failures).finish(keep=given.page or not partial)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--regime", action="append", choices=[r.name for r in REGIMES])
    parser.add_argument("--count", type=int, help="trials of each regime")
    parser.add_argument("--page", action="store_true", help="make the page of what is done")
    parser.add_argument(
        "--slice", action="store_true", help="a few trials, apart from the study; no page written"
    )
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--file", type=Path, help="where finished trials are kept, one a line")
    return parser.parse_args()


def run(names: Sequence[str], file: Path, processes: int) -> dict[str, str]:
    """Run what is missing; failures by name."""
    done = run_study(
        names, work_of(unfit), file, program(physical=False), processes=processes, words=words,
        key=id_of,
    )  # fmt: skip
    return done.failures


def make_page(
    rows: Sequence[dict[str, Any]],
    missing: int,
    failures: dict[str, str],
    name: str = "trials",
    title: str = "Blind trials",
) -> Outcome:
    """A study as a page, as `sysid trials` makes it.

    Args:
        rows: Of finished trials.
        missing: Trials of the plan that are not done.
        failures: Name → reason.
        name: Stem of the files.
        title: Heading.
    """
    page = Outcome(name, title)
    made = page_of([result_of(row) for row in rows], missing, failures)
    page.lines = [made.text.partition("\n")[2].strip("\n")]
    page.numbers = made.numbers
    return page


if __name__ == "__main__":
    main()
