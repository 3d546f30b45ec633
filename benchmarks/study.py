"""Studies of hours: named pieces of work on several processes, finished ones kept and not redone.

Every finished piece is one line of a file, with the program that made it; lines of another program
do not count and are put aside.
"""

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from same_program import same_as
from work_file import FOLDER, put_aside

from sysid.cli.console import Talk
from sysid.cli.workers import pool, prepare_to_diagnose, teller
from sysid.jobs.job import Ended, Job, Work
from sysid.jobs.run import Done, run_jobs


def study_parser(about: str, quick: str) -> argparse.ArgumentParser:
    """Options that every study has: `--processes`, `--quick` and `--page`.

    Args:
        about: What the script does.
        quick: What it does with `--quick`.
    """
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--quick", action="store_true", help=f"{quick}, nothing written")
    parser.add_argument("--page", action="store_true", help="make the page of what is done")
    return parser


def name_of(row: dict[str, Any]) -> str | None:
    """The piece of work whose result a row is."""
    return row.get("id")


def run_study(
    names: Sequence[str],
    work: Work,
    file: Path,
    program: str,
    *,
    processes: int,
    words: Callable[[Ended], str],
    key: Callable[[dict[str, Any]], str | None] = name_of,
) -> Done:
    """Do what is missing; nothing is put aside while another study writes the file.

    Args:
        names: Of all pieces.
        work: Function of a module: name → row, which holds its name and program.
        file: Of rows.
        program: Rows of other ones are put aside, but for those that are the same as it
            (`same_program.py`).
        processes: At once.
        words: What became of a piece.
        key: Name of a row's piece.
    """
    first = partial(put_aside, file, same_as(program), FOLDER / f"{file.stem}_aside.jsonl")
    talk, jobs = Talk(), [Job(name, name) for name in names]
    with pool(talk, processes, None, len(jobs)) as workers:
        return run_jobs(
            jobs, work, workers, file, key, prepare=prepare_to_diagnose, tell=teller(talk, words),
            first=first,
        )  # fmt: skip
