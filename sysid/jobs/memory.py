"""Memory of a process that does many pieces of work: compiled programs pile up."""

import ctypes
import gc
import os
import sys
from pathlib import Path
from typing import Final

LEAST: Final = 2_500_000_000
"""Bytes that a process may always hold before it forgets its compiled programs.  Campaigns of other
sizes are other programs, 25 MB each: two hundred trials in one process had come to 5.4 GB.  On disk
they stay, but not what leads to them: trials that forgot theirs every few minutes spent a third
of their time on tracing them again."""
SHARE: Final = 0.6
"""Of the machine's memory, that one process on each core may hold together where that is more."""
OF_WORKER: Final = 0.7
"""Of what Dask lets a worker hold before it ends it, with the work that it is at."""
_STATM: Final = Path("/proc/self/statm")


def resident() -> int | None:
    """Bytes of memory that this process holds; None where the system does not tell."""
    try:
        return int(_STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError):
        return None


def allowed() -> int:
    """Bytes that a process may hold: its core's share of the machine, `LEAST` at least.

    A worker of Dask less than what it would be ended for, which is little on a small machine.
    """
    limit = _of_worker()
    share = _share()
    return share if limit is None else min(share, int(OF_WORKER * limit))


def _of_worker() -> int | None:
    """Bytes for which Dask would end the worker that this process is; None if it is none."""
    distributed = sys.modules.get("distributed")
    if distributed is None:
        return None
    try:
        return distributed.get_worker().memory_manager.memory_limit or None
    except (ValueError, AttributeError):  # no worker, or one that has no such limit
        return None


def _share() -> int:
    try:
        whole = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, AttributeError):
        return LEAST
    return max(LEAST, int(SHARE * whole / (os.cpu_count() or 1)))


def forget_programs(most: int | None = None) -> bool:
    """Drop all compiled programs of this process if it holds too much memory.

    Args:
        most: Bytes; what is `allowed` if None.

    Returns:
        Whether it did.
    """
    held = resident()
    jax = sys.modules.get("jax")
    if held is None or held <= (allowed() if most is None else most) or jax is None:
        return False
    jax.clear_caches()
    gc.collect()
    _give_back()
    return True


def _give_back() -> None:
    """Hand what was freed back to the system; glibc keeps it otherwise."""
    try:
        ctypes.CDLL(None).malloc_trim(0)
    except (OSError, TypeError, AttributeError):  # another C library
        return
