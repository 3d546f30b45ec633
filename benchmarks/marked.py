"""Trials that leave a trace of every time they are begun; apart, since workers import it."""

import os
import resource
from typing import Any

from sysid.cli.soundness import unfit
from sysid.trials.one import work_of


def marked_trial(spec: tuple[str, str]) -> dict[str, Any]:
    """Run a trial; its row, with the process that made it and that one's peak memory so far."""
    name, file = spec
    with open(file, "a", encoding="utf-8") as out:
        out.write(f"{name} {os.getpid()}\n")
    row = work_of(unfit)(name)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return row | {"pid": os.getpid(), "peak_bytes": peak}
