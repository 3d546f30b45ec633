"""Trials that two programs answer otherwise: what a change did to all that both have done.

`same_program.py` asks whether nothing changed, by a few trials drawn by lot.  Where something did,
one kind of effect may suffer of which a lot holds none; so every trial is looked at here.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from outcome import RESULTS
from work_file import read_rows

from sysid.trials.one import id_of

STUDY: Final = RESULTS / "trials.jsonl"


@dataclass(frozen=True)
class Changed:
    """A trial with two answers.

    Attributes:
        id: Of the trial.
        hidden: Causes that were planted.
        before: What the first program answered, in words.
        after: What the second did.
        worse: Difference of the faults (what is missed, wrong or too many); negative if better.
    """

    id: str
    hidden: str
    before: str
    after: str
    worse: int


def changed_answers(
    before: Iterable[dict[str, Any]], after: Iterable[dict[str, Any]]
) -> tuple[list[Changed], int]:
    """Trials with other verdicts, and how many both have done.

    Args:
        before: Rows of one program.
        after: Of another, or of several: the last row of a trial counts.  Failed trials are in
            neither.
    """
    first = {id_of(row): row for row in before if not row.get("failure")}
    last = {id_of(row): row for row in after if not row.get("failure")}
    found, both = [], 0
    for id, row in last.items():
        old = first.get(id)
        if old is None:
            continue
        both += 1
        if told(old) != told(row):
            worse = faults(row) - faults(old)
            hidden = " + ".join(row["causes"]) or "nothing"
            found.append(Changed(row["id"], hidden, told(old), told(row), worse))
    return found, both


def told(row: Mapping[str, Any]) -> str:
    """An answer with its verdicts, in words; the order of the causes does not matter."""
    judged = row["score"]["judged"]
    causes = [f"{'/'.join(sorted(j['given']['members']))} ({j['verdict']})" for j in judged]
    return ", ".join(sorted(causes)) or str(row["answer"])


def faults(row: Mapping[str, Any]) -> int:
    """How many causes are missed, told by their family alone, wrong or too many."""
    score = row["score"]
    missed = sum(not kind.endswith(("name", "class")) for kind in score["found"])
    return missed + sum(j["verdict"] == "wrong" for j in score["judged"])


def lines(changed: Sequence[Changed], both: int) -> list[str]:
    """What to print: better ones, worse ones, and the others."""
    count = Counter(
        "worse" if c.worse > 0 else "better" if c.worse < 0 else "else" for c in changed
    )
    head = f"{both} trials of both: {len(changed)} with another answer, "
    head += f"{count['worse']} of them worse and {count['better']} better"
    ranked = sorted(changed, key=lambda c: (-c.worse, c.id))
    return [head, *(f"{c.worse:+d} {c.id} ({c.hidden}): {c.before}; now {c.after}" for c in ranked)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("after", type=Path, help="rows of the changed program")
    parser.add_argument("--before", type=Path, default=STUDY, help="rows to hold them against")
    given = parser.parse_args()
    print("\n".join(lines(*changed_answers(read_rows(given.before), read_rows(given.after)))))


if __name__ == "__main__":
    sys.exit(main())
