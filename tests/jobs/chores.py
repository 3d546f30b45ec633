"""Cheap work, importable by worker processes, that leaves a trace of every time it is begun."""

import os
import time
from pathlib import Path
from typing import Any

from sysid.errors import DataError
from sysid.jobs.cluster import MEMORY
from sysid.jobs.job import Job


def jobs(folder: Path, count: int, seconds: float = 0.0) -> list[Job]:
    return [Job(f"job-{k}", (str(folder), k, seconds)) for k in range(count)]


def nothing() -> None:
    """Preparing takes nothing."""


def mark_prepared() -> None:
    with open(os.environ["SYSID_TEST_PREPARED"], "a") as out:
        out.write(f"{os.getpid()}\n")


def chore(spec: tuple[str, int, float]) -> dict[str, Any]:
    """Write down that it was begun, wait, and square."""
    folder, number, seconds = spec
    with open(Path(folder) / "begun", "a") as out:
        out.write(f"{number} {os.getpid()}\n")
    time.sleep(seconds)
    return {"name": f"job-{number}", "square": number**2, "pid": os.getpid()}


def picky(spec: tuple[str, int, float]) -> dict[str, Any]:
    """Fails for some."""
    if spec[1] == 1:
        raise DataError("is empty", where="a.csv", advice="Export it")
    if spec[1] == 2:
        raise ZeroDivisionError("division by zero")
    return chore(spec)


def stopped(spec: tuple[str, int, float]) -> dict[str, Any]:
    """The user presses Ctrl-C at the third."""
    if spec[1] == 2:
        raise KeyboardInterrupt
    return chore(spec)


def deadly(spec: tuple[str, int, float]) -> dict[str, Any]:
    """Takes its process with it."""
    if spec[1] == 1:
        os._exit(1)
    return chore(spec)


def deadly_after_a_while(spec: tuple[str, int, float]) -> dict[str, Any]:
    """Takes its process with it when other jobs have come to lie beside it."""
    if spec[1] == 1:
        time.sleep(spec[2])
        os._exit(1)
    return chore(spec)


def begun(folder: Path) -> list[tuple[int, int]]:
    """(job, pid) of every time that a job was begun."""
    lines = (folder / "begun").read_text().splitlines() if (folder / "begun").exists() else []
    return [(int(a), int(b)) for a, b in (line.split() for line in lines)]


def key(row: dict[str, Any]) -> str | None:
    return row.get("name")


def environment() -> dict[str, str]:
    """Of the process that this runs in."""
    return dict(os.environ)


def memory_rules() -> dict[str, Any]:
    """What a worker does where memory gets short."""
    import dask.config

    return {name: dask.config.get(name) for name in MEMORY}
