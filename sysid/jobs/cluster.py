"""Workers on Dask: a cluster of our own on this machine, or one that is there already."""

import logging
import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from sysid.errors import ClusterError
from sysid.jobs.job import Ended, Job, Prepare, Work, attempt

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster

ONE_THREAD: Final = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "NPROC": "1"}
"""A worker uses one core: BLAS, OpenMP and XLA have one thread each."""
MEMORY: Final = {
    f"distributed.worker.memory.{what}": False for what in ("target", "spill", "pause")
}
"""Compiled programs are nothing that Dask could spill: a worker that pauses would wait for ever.
It is ended and started anew at 95 % of its share instead."""
AHEAD: Final = 2
"""Jobs that are with the scheduler at once, for each thread of the workers."""
_LOOK, _COUNT = 0.05, 5.0
"""s between looks at what has ended, and between counts of the workers."""
_KILLER: Final = "every worker that tried it died; memory may have run out"


def is_installed() -> bool:
    """Whether Dask is there."""
    try:
        import distributed  # noqa: F401  # asked for only
    except ImportError:
        return False
    return True


@dataclass
class Cluster:
    """Workers of a Dask scheduler.

    A job that a dead worker had goes to another one.  After four dead workers (Dask's rule) nobody
    knows whether it killed them or lay beside the one that did, so it is tried once more at the
    end, with nothing beside it; it has failed where that ends the same way.  When the scheduler is
    lost, its jobs are given again to the one that comes back at the address.

    Attributes:
        workers: Of a cluster of our own, one thread each; unused with an address.
        address: Of a scheduler that is there already, such as ``tcp://host:8786``.
        patience: How long a lost scheduler is waited for, s.
        warn: Called with sentences.
    """

    workers: int = 1
    address: str | None = None
    patience: float = 120.0
    warn: Callable[[str], None] = print
    _client: "Client | None" = field(default=None, init=False, repr=False)
    _local: "LocalCluster | None" = field(default=None, init=False, repr=False)
    _alone: bool = field(default=False, init=False, repr=False)

    def __enter__(self) -> "Cluster":
        """Start the workers, or find the scheduler.

        Raises:
            ClusterError: Dask or the scheduler is not there, or the address is none.
        """
        if not is_installed():
            raise ClusterError(
                "Dask is not installed", advice='Install it with: pip install "sysid[cluster]"'
            )
        from distributed import LocalCluster

        # what it logs of workers that die or schedulers that go is told by us, once
        logging.getLogger("distributed").setLevel(logging.CRITICAL)
        if self.address is None:
            # spawned, so each a fresh interpreter: JAX does not survive a fork
            self._local = LocalCluster(
                n_workers=self.workers, threads_per_worker=1, processes=True, env=ONE_THREAD,
                config=MEMORY, preload=["sysid.jobs.undisturbed"], silence_logs=logging.CRITICAL,
                dashboard_address="127.0.0.1:0",  # any free port: two clusters may run side by side
            )  # fmt: skip
        try:
            self._connect(10.0)
        except ClusterError:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the scheduler; end our own workers."""
        for one in (self._client, self._local):
            if one is not None:
                with suppress(Exception):
                    one.close(timeout=5)
        self._client = self._local = None

    @property
    def pids(self) -> tuple[int, ...]:
        """Process ids of the workers."""
        assert self._client is not None
        found: Any = self._client.run(os.getpid)
        return tuple(found.values())

    def results(self, jobs: Sequence[Job], work: Work, prepare: Prepare) -> Iterator[Ended]:
        """See `Pool`; no more jobs are under way at once than keep the workers busy."""
        waiting = deque(jobs)
        away: dict[str, tuple[Job, Future]] = {}
        suspects: deque[Job] = deque()
        alone = ""
        most, counted = AHEAD, -_COUNT
        try:
            while waiting or away or suspects:
                if self._reconnected():
                    waiting.extendleft(job for job, _ in reversed(away.values()))
                    away.clear()
                client = self._client
                assert client is not None
                with suppress(OSError, RuntimeError):  # the scheduler has just gone
                    if time.monotonic() - counted > _COUNT:
                        most, counted = AHEAD * max(1, self._threads()), time.monotonic()
                    if suspects and not waiting and not away:
                        waiting.append(suspects.popleft())
                        alone = waiting[0].key
                    while waiting and len(away) < most:
                        job = waiting[0]
                        name = f"{job.key}-{time.monotonic_ns()}"
                        future = client.submit(attempt, job, work, prepare, key=name, pure=False)
                        away[job.key] = job, future
                        waiting.popleft()
                lost, killed, ended = _sorted_out(away)
                suspects.extend(job for job in killed if job.key != alone)
                yield from ended
                yield from (Ended(job.key, None, _KILLER) for job in killed if job.key == alone)
                waiting.extendleft(reversed(lost))
                if not ended:
                    time.sleep(_LOOK)
        finally:
            if self._client is not None and away:
                with suppress(Exception):
                    self._client.cancel([future for _, future in away.values()], force=True)

    def _threads(self) -> int:
        """Of all workers there are now; of our own, missing ones are started anew.

        Dask gives a dead worker up that is not back after 15 s, which takes a busy machine longer.
        One that could not start, since the dead one's name was still taken, it keeps for good.
        """
        from distributed import Status

        assert self._client is not None
        if self._local is not None:
            nannies: Any = self._local.workers
            for name, nanny in list(nannies.items()):
                if nanny.status in (Status.failed, Status.closed):
                    nannies.pop(name, None)
            self._local.scale(self.workers)
        found: Any = self._client.nthreads()
        if not found and not self._alone:
            self.warn("The scheduler has no workers; waiting for some.")
        self._alone = not found
        return sum(found.values())

    def _reconnected(self) -> bool:
        """Whether the scheduler was lost, and is there again.

        Raises:
            ClusterError: It does not come back.
        """
        if self._client is not None and self._client.status == "running":
            return False
        self.warn("The scheduler is lost; waiting for it to come back.")
        self._connect(self.patience)
        return True

    def _connect(self, patience: float) -> None:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port

        if self._local is None and self.address is not None:
            try:  # a client would try a wrong one for long
                get_address_host_port(self.address, strict=False)
            except ValueError as cause:
                raise ClusterError(
                    f"is no address of a Dask scheduler ({cause})",
                    where=self.address,
                    advice="Write it as tcp://HOST:8786",
                ) from cause
        if self._client is not None:
            with suppress(Exception):
                self._client.close(timeout=1)
        place = self.address if self._local is None else self._local
        end = time.monotonic() + patience
        why = ""
        while (left := end - time.monotonic()) > 0.0:
            try:
                self._client = Client(place, timeout=max(0.5, min(left, 5.0)), set_as_default=False)
                return
            except (OSError, ValueError, ImportError) as cause:
                why = str(cause).strip().rstrip(".")
                if isinstance(cause, ValueError):
                    break
                time.sleep(0.2)
        raise ClusterError(
            f"no Dask scheduler answers ({why or 'no time was left'})",
            where=self.address,
            advice="Start it (dask scheduler; dask worker ADDRESS --nthreads 1), then give the "
            "same command again: what is finished is kept",
        )


def _sorted_out(
    away: "dict[str, tuple[Job, Future]]",
) -> tuple[list[Job], list[Job], list[Ended]]:
    """Take out what has ended: jobs to give again, jobs whose workers all died, and results."""
    from distributed import CancelledError
    from distributed.scheduler import KilledWorker

    lost: list[Job] = []
    killed: list[Job] = []
    ended: list[Ended] = []
    for key, (job, future) in list(away.items()):
        status = future.status
        if status == "pending":
            continue
        del away[key]
        if status == "error":
            error: Any = future.exception()
            if isinstance(error, KilledWorker):
                killed.append(job)
            else:
                ended.append(Ended(key, None, _why(error)))
        elif status == "finished":
            try:
                ended.append(future.result(timeout=30))
            except (CancelledError, OSError, TimeoutError):  # its worker died with the result
                lost.append(job)
        else:
            lost.append(job)
    return lost, killed, ended


def _why(error: BaseException | None) -> str:
    """What became of a job that the workers could not even try."""
    if isinstance(error, ModuleNotFoundError):
        return f"workers cannot import {error.name}: install the same sysid there"
    return " ".join(f"{type(error).__name__}: {error}".split())[:300]
