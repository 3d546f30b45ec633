"""Doing what is not done yet: results are kept as they come, and never made twice."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from sysid.errors import OutputError, Stopped
from sysid.jobs.job import Ended, Job, Pool, Prepare, Work
from sysid.jobs.rows import add_row, read_rows


@dataclass(frozen=True)
class Done:
    """What a run leaves.

    Attributes:
        rows: Key → result, of every job that was asked for and is finished, now or before.
        failures: Key → why, of the others.
        new: How many were finished in this run.
    """

    rows: dict[str, dict[str, Any]]
    failures: dict[str, str]
    new: int


Told = Callable[[int, int, Ended], None]
"""Called with (ended now, of so many, how it ended)."""


def run_jobs(
    jobs: Sequence[Job],
    work: Work,
    pool: Pool,
    file: Path,
    key: Callable[[dict[str, Any]], str | None],
    *,
    prepare: Prepare,
    tell: Told,
    first: Callable[[], None] | None = None,
) -> Done:
    """Do the jobs whose results the file does not hold.

    Only this process writes the file, a line as soon as a job is finished.  Failed jobs leave no
    line: the next run tries them again.

    Args:
        jobs: With keys that differ.
        work: Function of a module, spec → row.
        pool: Who does them.
        file: Of rows; is made if absent.
        key: The job whose result a row is; None where it is none of ours.
        prepare: Called once in every process that works.
        tell: Progress.
        first: Called before the file is read, when nobody else writes it; may replace the file.

    Raises:
        OutputError: The file cannot be written, or another run writes it.
        Stopped: The user pressed Ctrl-C; what is finished is kept.
        ClusterError: The workers are gone for good; what is finished is kept.
        ValueError: Two jobs have the same key.
    """
    wanted = {job.key for job in jobs}
    if len(wanted) < len(jobs):
        raise ValueError("two jobs have the same key")
    with _alone(file, first):
        rows = {k: row for row in read_rows(file) if (k := key(row)) in wanted and k is not None}
        left = [job for job in jobs if job.key not in rows]
        failures: dict[str, str] = {}
        new = 0
        try:
            for ended in pool.results(left, work, prepare):
                if ended.row is None:
                    failures[ended.key] = ended.failure or "no reason was given"
                else:
                    add_row(ended.row, file)
                    rows[ended.key] = ended.row
                    new += 1
                tell(new + len(failures), len(left), ended)
        except KeyboardInterrupt as cause:
            raise Stopped(
                f"Stopped. {len(rows)} of {len(jobs)} are finished and kept in {file}; "
                "the same command goes on from there."
            ) from cause
    return Done({job.key: rows[job.key] for job in jobs if job.key in rows}, failures, new)


@contextmanager
def _alone(file: Path, first: Callable[[], None] | None = None) -> Iterator[None]:
    """Nobody else writes this file meanwhile, also where what comes first puts another in place."""
    try:
        import fcntl  # noqa: F401  # asked for only
    except ImportError:  # not on this system
        if first is not None:
            first()
        yield
        return
    with _locked(file) as lock:
        if first is not None:
            first()
        if _in_place(lock, file):
            yield
            return
        with _locked(file):  # both: who had opened the former one is still refused
            yield


def _locked(file: Path) -> IO[bytes]:
    """The file that is in place, opened and locked; it is the lock that others look at, too."""
    import fcntl

    while True:
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            lock = file.open("ab")
        except OSError as cause:
            raise OutputError(
                f"cannot be written: {cause.strerror}",
                where=file,
                advice="Give another folder (-o)",
            ) from cause
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError) as cause:
            lock.close()
            raise OutputError(
                "is being written by another run",
                where=file,
                advice="Wait for it, stop it, or give another folder (-o)",
            ) from cause
        except OSError:
            return lock  # a file system that knows no locks: nobody else can be seen there
        if _in_place(lock, file):
            return lock
        lock.close()  # another run replaced it before it was locked


def _in_place(lock: IO[bytes], file: Path) -> bool:
    """Whether an open file is still the one of its name."""
    try:
        return os.path.samestat(os.fstat(lock.fileno()), file.stat())
    except FileNotFoundError:
        return False
