"""Who does many pieces of work: this process, workers on this machine, or a cluster."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from sysid.cli.console import Talk
from sysid.jobs.job import Ended, Here, Pool

Workers = Annotated[
    int | None,
    typer.Option(
        "--workers", metavar="N", min=1,
        help="Processes of one thread on this machine; as many as it has cores if not given.",
    ),
]  # fmt: skip
SchedulerOption = Annotated[
    str | None,
    typer.Option(
        "--scheduler", metavar="ADDRESS",
        help="Use the workers of this Dask scheduler, e.g. tcp://host:8786.",
    ),
]  # fmt: skip
INSTALL = 'pip install "sysid[cluster]"'


@contextmanager
def pool(talk: Talk, workers: int | None, scheduler: str | None, most: int) -> Iterator[Pool]:
    """Workers, as long as they are needed.

    Args:
        talk: To tell what cannot be had.
        workers: On this machine; None for as many as it has cores.
        scheduler: Of a cluster that is there.
        most: Pieces of work: more workers would have nothing to do.

    Raises:
        ClusterError: The scheduler does not answer, or Dask is missing where it is asked for.
    """
    if scheduler is not None and workers is not None:
        raise typer.BadParameter(
            "a scheduler has its own workers: give --workers or --scheduler, not both"
        )
    if scheduler is None:
        count = min(workers or cores(), most)
        if count <= 1:
            yield Here()
            return
        from sysid.jobs.cluster import is_installed

        if not is_installed():
            talk.warn(
                f"Dask is not installed ({INSTALL}): one after the other in this process instead."
            )
            yield Here()
            return
    else:
        count = 1

    from sysid.jobs.cluster import Cluster

    with Cluster(workers=count, address=scheduler, warn=talk.warn) as cluster:
        yield cluster


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def prepare_worker() -> None:
    """Compiled programs are shared between processes and runs."""
    from sysid.cli.compile_cache import keep_compiled

    keep_compiled(Talk(quiet=True))


def prepare_to_diagnose() -> None:
    """The same, where every piece of work compiles programs of its own."""
    from sysid.cli.compile_cache import keep_compiled

    keep_compiled(Talk(quiet=True), many=True)


def teller(talk: Talk, words: Callable[[Ended], str]) -> Callable[[int, int, Ended], None]:
    """Says a line for every piece of work that ended, with the time that the rest will take."""
    import time

    begin = time.monotonic()

    def tell(n: int, of: int, ended: Ended) -> None:
        left = (time.monotonic() - begin) / n * (of - n)
        rest = f"; {left / 60:.0f} min left" if left > 90 else ""
        talk.note(f"{n}/{of} {ended.key}: {ended.failure or words(ended)}{rest}")

    return tell
