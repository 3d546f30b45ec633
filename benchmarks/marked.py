"""Trials that leave a trace of every time they are begun; apart, since workers import it."""

import os
import resource
import time
from collections.abc import Sequence
from typing import Any

from sysid.cli.soundness import unfit
from sysid.trials.one import work_of


def pace(names: Sequence[str]) -> float:
    """Trials a second after the first one, one after the other in this process."""
    work, begun = work_of(unfit), 0.0
    for k, name in enumerate(names):
        work(name)
        if k == 0:
            begun = time.perf_counter()
    return (len(names) - 1) / (time.perf_counter() - begun)


def marked_trial(spec: tuple[str, str]) -> dict[str, Any]:
    """Run a trial; its row, with the process that made it and that one's peak memory so far."""
    name, file = spec
    with open(file, "a", encoding="utf-8") as out:
        out.write(f"{name} {os.getpid()}\n")
    row = work_of(unfit)(name)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return row | {"pid": os.getpid(), "peak_bytes": peak}
