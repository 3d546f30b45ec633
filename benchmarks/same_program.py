"""Whether a changed program still gives the rows of a study: some pieces, drawn by lot, again.

Only for changes that no piece should feel, such as another message or one more check of files.
A lot can miss one kind of effect: `changed_answers.py` looks at every trial of a new study.
Where every row comes out as it was, rows of the former program count for this one as well, and
`results/same_program.json` says so, with the pieces that were done again.
"""

import argparse
import json
import math
import random
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from outcome import RESULTS
from work_file import FOLDER, read_rows

SAME: Final = RESULTS / "same_program.json"
TOLERANCE: Final = 1e-3
"""Relative difference of a number that other processors and compilers may make."""
OF_THE_RUN: Final = frozenset({"seconds", "preparation", "program", "took"})
"""What a row says of the run, not of the piece."""
STUDIES: Final = ("trials", "physical_trials", "coverage", "lumped_coverage", "poor_campaigns")
"""Whose rows can be held against those of a changed program."""


def same_as(program: str, file: Path = SAME) -> frozenset[str]:
    """A program and all former ones whose rows count for it.

    Args:
        program: Fingerprint.
        file: Of what was found.
    """
    found, last = {program}, {program}
    while last:
        last = {r["former"] for r in _records(file) if r["program"] in last} - found
        found |= last
    return frozenset(found)


def differences(before: Any, after: Any, where: str = "") -> list[str]:
    """Where two rows differ, in words; nothing where they do not.

    Args:
        before: Row, or a part of one.
        after: The same of the other program.
        where: Of the part.
    """
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        names = [n for n in sorted({*before, *after}) if where or n not in OF_THE_RUN]
        pairs = [(before.get(n), after.get(n), f"{where}.{n}".lstrip(".")) for n in names]
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        pairs = [
            (a, b, f"{where}[{k}]") for k, (a, b) in enumerate(zip(before, after, strict=True))
        ]
    else:
        return [] if _same(before, after) else [f"{where}: {before!r}, now {after!r}"]
    return [line for a, b, name in pairs for line in differences(a, b, name)]


def drawn(names: Sequence[str], program: str, count: int) -> list[str]:
    """Pieces to do again: by lot, and nobody's choice.

    Args:
        names: Of all.
        program: Fingerprint, which decides the lot.
        count: At most.
    """
    return random.Random(program).sample(sorted(names), min(count, len(names)))


@dataclass(frozen=True)
class Study:
    """What is needed to do a piece of a study again.

    Attributes:
        file: Of its rows.
        work: Name → row.
        program: Fingerprint of the program as it is.
        key: Name of a row's piece.
    """

    file: Path
    work: Callable[[str], dict[str, Any]]
    program: str
    key: Callable[[dict[str, Any]], str | None]


def study_of(name: str) -> Study:
    """Look a study up.

    Args:
        name: One of `STUDIES`.
    """
    if name in ("trials", "physical_trials"):
        from sysid.cli.soundness import unfit
        from sysid.trials.one import id_of, work_of
        from sysid.trials.program import program

        mine = program(physical=name == "physical_trials")
        return Study(RESULTS / f"{name}.jsonl", work_of(unfit), mine, id_of)
    from study import name_of

    module = import_module(name)
    return Study(RESULTS / f"{name}.jsonl", module.work, module.PROGRAM, name_of)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--why", required=True, help="what was changed, in a sentence")
    parser.add_argument("--study", choices=STUDIES, default="trials")
    parser.add_argument("--count", type=int, default=20, help="pieces that are done again")
    parser.add_argument("--also", action="append", default=[], metavar="NAME",
                        help="a piece that goes the changed way, besides those drawn")  # fmt: skip
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--file", type=Path, help="of rows, if not the study's own")
    given = parser.parse_args()
    if given.processes < 2:  # one alone would be this process, with all its threads
        parser.error("rows were made by processes of one thread, and rounding tells them apart")
    study = study_of(given.study)
    study = replace(study, file=given.file) if given.file else study
    sys.exit(_compare(study, given.why, given.count, given.processes, given.also))


def _compare(study: Study, why: str, count: int, processes: int, also: Sequence[str]) -> int:
    from study import run_study

    mine = study.program
    rows = [row for row in read_rows(study.file) if row.get("program") not in same_as(mine)]
    if not rows:
        print(f"All rows of {study.file.name} count for the program as it is, {mine}")
        return 0
    ((former, _),) = Counter(row["program"] for row in rows).most_common(1)
    before = {study.key(row): row for row in rows if row["program"] == former}
    if unknown := [name for name in also if name not in before]:
        sys.exit(f"The study has no {', '.join(unknown)}")
    names = drawn([name for name in before if name], mine, count)
    names += [name for name in also if name not in names]
    file = FOLDER / f"same_{study.file.name}"
    run_study(names, study.work, file, mine, processes=processes, words=_words, key=study.key)
    after = {study.key(row): row for row in read_rows(file)}
    if missing := [name for name in names if name not in after]:
        print(f"Not finished: {', '.join(missing)}")
        return 1
    told = {name: differences(before[name], after[name]) for name in names}
    for name in names:
        print(f"{name}: {'; '.join(told[name]) or 'the same'}")
    if any(told.values()):
        print(f"Rows of {former} do not count for {mine}")
        return 1
    record = {"program": mine, "former": former, "why": why, "trials": names}
    text = json.dumps([*_records(SAME), record], indent=1, ensure_ascii=False)
    SAME.write_text(text + "\n", encoding="utf-8")
    print(f"All {len(names)} are the same: rows of {former} count for {mine}")
    return 0


def _words(ended: Any) -> str:
    return "done again" if ended.row else "nothing came of it"


def _records(file: Path) -> list[dict[str, Any]]:
    return json.loads(file.read_text("utf-8")) if file.exists() else []


def _same(before: object, after: object) -> bool:
    if isinstance(before, float | int) and isinstance(after, float | int):
        neither = math.isnan(before) and math.isnan(after)
        return neither or math.isclose(before, after, rel_tol=TOLERANCE)
    return before == after


if __name__ == "__main__":
    main()
