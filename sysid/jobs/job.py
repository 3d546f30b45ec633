"""One piece of work, and how it ended."""

import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

from sysid.errors import SysidError
from sysid.jobs.memory import forget_programs


@dataclass(frozen=True)
class Job:
    """One piece of work.

    Attributes:
        key: Its name, by which its result is known.
        spec: What the work is done on; goes to a worker, so it must be picklable.
    """

    key: str
    spec: Any


@dataclass(frozen=True)
class Ended:
    """A piece of work that came to an end.

    Attributes:
        key: Of the job.
        row: Its result, for a line of JSON; None where it failed.
        failure: Why, one sentence; None where it did not.
    """

    key: str
    row: dict[str, Any] | None
    failure: str | None = None


Work = Callable[[Any], dict[str, Any]]
"""A function of a module, since workers import it: spec → row."""
Prepare = Callable[[], None]
"""Called once in every process that works, likewise of a module."""


class Pool(Protocol):
    """Whatever does jobs: this process, or workers elsewhere."""

    def results(self, jobs: Sequence[Job], work: Work, prepare: Prepare) -> Iterator[Ended]:
        """Do all of them; every job ends once, in any order.

        Args:
            jobs: With keys that differ.
            work: What is done.
            prepare: Before a process does its first.
        """
        ...


def attempt(job: Job, work: Work, prepare: Prepare) -> Ended:
    """Do one job where we are; whatever goes wrong is its failure and nobody else's."""
    try:
        _once(prepare)
        return Ended(job.key, work(job.spec))
    except SysidError as error:
        return Ended(job.key, None, str(error))
    except Exception as error:
        return Ended(job.key, None, crash(error))
    finally:
        forget_programs()


def crash(error: Exception) -> str:
    """What a defect of the program did, and where, in one line."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    said = " ".join(f"{type(error).__name__}: {error}".split())[:300]
    return f"crashed in {place.name}, line {place.lineno}: {said}"


@lru_cache(maxsize=8)
def _once(prepare: Prepare) -> None:
    prepare()


@dataclass(frozen=True)
class Here:
    """One job after the other in this process."""

    def results(self, jobs: Sequence[Job], work: Work, prepare: Prepare) -> Iterator[Ended]:
        """See `Pool`."""
        for job in jobs:
            yield attempt(job, work, prepare)
