"""Fits that do not wait for each other, on the cores there are."""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Final, TypeVar

MOST: Final = 4
"""Threads: most of a fit is compiled programs and linear algebra, which run side by side, but not
all of it."""

One = TypeVar("One")
Found = TypeVar("Found")


def at_once(work: Callable[[One], Found], items: Iterable[One]) -> list[Found]:
    """What `work` makes of each item, in their order; the first exception is raised."""
    with ThreadPoolExecutor(min(MOST, _cores())) as threads:
        return list(threads.map(work, items))


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
