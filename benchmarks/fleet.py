"""Real blind trials on Dask: two workers against one, and one of two killed at half time.

Workers have one thread each and are started anew for each run; the run with the kill comes first
and fills the cache of compiled programs for the other two.  What the machine allows is how much
faster two processes that share nothing but its cores do such trials than one, without Dask.
"""

import argparse
import os
import signal
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from marked import marked_trial, pace
from outcome import Outcome

from sysid.cli.workers import prepare_to_diagnose
from sysid.jobs.cluster import ONE_THREAD, Cluster
from sysid.jobs.job import Ended, Job
from sysid.jobs.rows import read_rows
from sysid.jobs.run import run_jobs
from sysid.trials.one import id_of
from sysid.trials.trial_id import FIRST_SEED

TARGET = 1.8


@dataclass
class Ran:
    """One run.

    Attributes:
        seconds: From the first job given to the last result, workers started before.
        ends: (s, process) of every result.
        begun: Trial → times that it was begun.
        lines: Trial → lines in the file of results.
        failures: Trials without a result.
        rows: Results.
        killed: The process that was killed; None if none was.
    """

    seconds: float
    ends: list[tuple[float, int]]
    begun: Counter[str]
    lines: Counter[str]
    failures: dict[str, str]
    rows: list[dict[str, Any]]
    killed: int | None

    @property
    def rate(self) -> float:
        """Trials a second, warm: of every worker from its first result to its last, added up."""
        total = 0.0
        for pid in {pid for _, pid in self.ends}:
            times = [t for t, p in self.ends if p == pid]
            if len(times) > 1:
                total += (len(times) - 1) / (times[-1] - times[0])
        return total


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=12)
    parser.add_argument("--regime", default="none")
    parser.add_argument("--quick", action="store_true", help="2 trials, nothing written")
    given = parser.parse_args()
    count = 2 if given.quick else given.trials
    names = [f"{given.regime}:{FIRST_SEED[given.regime] + k}" for k in range(count)]
    killed, one, two = run(names, 2, kill=True), run(names, 1), run(names, 2)
    some = names[: max(2, count // 2)]
    page = make_page(names, killed, one, two)
    add_bound(page, len(some), paces(some, 2) / paces(some, 1))
    page.finish(keep=not given.quick)


def paces(names: list[str], processes: int) -> float:
    """Trials a second of processes that know nothing of each other, each with all trials."""
    os.environ.update(ONE_THREAD)
    with ProcessPoolExecutor(
        processes, mp_context=get_context("spawn"), initializer=prepare_to_diagnose
    ) as pool:
        return sum(pool.map(pace, [names] * processes))


def add_bound(page: Outcome, count: int, bound: float) -> None:
    """What two cores of this machine are worth."""
    page.say(
        f"Two processes without Dask that share nothing but the machine, each with "
        f"{count} of these trials, do {bound:.2f} × as many a second as one: more no scheduler can "
        "get from it."
    )
    page.numbers |= {"without_dask_ratio": bound}


def run(names: list[str], workers: int, kill: bool = False) -> Ran:
    """All trials on fresh workers; one of them killed when half of the trials are done."""
    with tempfile.TemporaryDirectory() as folder:
        file, traces = Path(folder) / "rows.jsonl", Path(folder) / "begun"
        jobs = [Job(name, (name, str(traces))) for name in names]
        dead: list[int] = []
        ends: list[tuple[float, int]] = []

        def tell(n: int, of: int, ended: Ended) -> None:
            print(f"{workers} workers: {n}/{of} {ended.key} {ended.failure or ''}",
                  file=sys.stderr, flush=True)  # fmt: skip
            if ended.row is not None:
                ends.append((time.perf_counter(), ended.row["pid"]))
            if kill and n == len(names) // 2:
                dead.append(busy(traces, file))
                os.kill(dead[-1], signal.SIGKILL)

        with Cluster(workers=workers) as cluster:
            begin = time.perf_counter()
            done = run_jobs(
                jobs, marked_trial, cluster, file, id_of, prepare=prepare_to_diagnose, tell=tell
            )
            seconds = time.perf_counter() - begin
        begun = Counter(line.split()[0] for line in traces.read_text("utf-8").splitlines())
        lines = Counter(str(id_of(row)) for row in read_rows(file))
        return Ran(seconds, ends, begun, lines, done.failures, list(done.rows.values()),
                   dead[0] if dead else None)  # fmt: skip


def busy(traces: Path, file: Path) -> int:
    """A process that is in the middle of a trial."""
    ended = {id_of(row) for row in read_rows(file)}
    begun = [line.split() for line in traces.read_text("utf-8").splitlines()]
    return next(int(pid) for name, pid in reversed(begun) if name not in ended)


def make_page(names: list[str], killed: Ran, one: Ran, two: Ran) -> Outcome:
    page = Outcome("fleet", "Blind trials on Dask workers")
    ratio, warm = one.seconds / two.seconds, two.rate / one.rate if one.rate else float("nan")
    once = set(killed.lines.values()) == {1} and set(killed.lines) == set(names)
    again = sorted(name for name, times in killed.begun.items() if times > 1)
    peak = max(row["peak_bytes"] for r in (killed, one, two) for row in r.rows) / 1e9
    page.say(
        f"{len(names)} trials ({names[0]} to {names[-1]}) on fresh one-threaded workers: "
        f"{one.seconds:.0f} s on one, {two.seconds:.0f} s on two: {ratio:.2f} ×, loading JAX and "
        f"compiled programs in each worker included. Without each worker's first trial, trials a "
        f"second: {warm:.2f} × (target {TARGET} ×)."
    )
    page.say(
        f"One of two workers killed with half of the trials done: {sum(killed.lines.values())} "
        f"results of {len(names)} trials, each {'exactly once' if once else 'NOT exactly once'}; "
        f"failures: {len(killed.failures)}; begun again: {', '.join(again) or 'none'}; "
        f"{killed.seconds:.0f} s."
    )
    same = all(answers(one)[name] == answers(z)[name] for z in (two, killed) for name in names)
    page.say(
        f"Answers and scores of the three runs are {'the same' if same else 'NOT the same'}. Peak "
        f"memory of a worker: {peak:.1f} GB."
    )
    page.numbers = {
        "trials": names, "one_s": one.seconds, "two_s": two.seconds, "ratio": ratio,
        "warm_ratio": warm,
        "killed_s": killed.seconds, "exactly_once": once, "begun_again": again,
        "failures": killed.failures, "same_answers": same, "peak_GB": peak,
    }  # fmt: skip
    return page


def answers(ran: Ran) -> dict[str, Any]:
    """Trial → what was answered and how it is judged."""
    return {str(id_of(row)): (row["answer"], row["base"], row["score"]) for row in ran.rows}


if __name__ == "__main__":
    main()
