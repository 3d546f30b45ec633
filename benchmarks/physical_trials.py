"""Blind trials on the physical damper, which no base matches: one mechanism is raised, or none.

What `sysid trials --regime physical` does, with results that stay with the others: every finished
trial is one line of a work file, so that a study goes on where it was.  Lines count for the program
that made them only; those of another one are put aside.
"""

import os

# As in `trials.py`: threads of BLAS only fight with JAX's own
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import RESULTS
from study import run_study, study_parser
from trials import make_page
from work_file import FOLDER, read_rows

from sysid.cli.soundness import unfit
from sysid.cli.trials import words
from sysid.trials.one import id_of, work_of
from sysid.trials.plan import COUNTS, Group, Plan
from sysid.trials.program import program
from sysid.trials.trial_id import PHYSICAL

WORK = RESULTS / "physical_trials.jsonl"


def main() -> None:
    given = study_parser(__doc__ or "", "one trial").parse_args()
    groups = (Group(regime=PHYSICAL, count=1 if given.quick else COUNTS[PHYSICAL]),)
    names = [str(trial) for trial in Plan(groups).trials()]
    file = FOLDER / "physical_trials_quick.jsonl" if given.quick else WORK
    failures: dict[str, str] = {}
    if not given.page:
        failures = run_study(
            names, work_of(unfit), file, program(physical=True), processes=given.processes,
            words=words, key=id_of,
        ).failures  # fmt: skip
    done = {name: row for row in read_rows(file) if (name := id_of(row)) in set(names)}
    rows = [done[name] for name in names if name in done]
    page = make_page(
        rows,
        len(names) - len(rows),
        failures,
        "physical_trials",
        "Blind trials on the physical damper",
    )
    page.finish(keep=not given.quick)


if __name__ == "__main__":
    main()
