"""A thousand dampers, 20 loops each: one batched program, against what one would do otherwise."""

import argparse
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import jax
import numpy as np
from best_known import NEAR
from fleet_dampers import END_OF_LINE, PLAN, POINTS, WIDE, Damper, draw_dampers
from outcome import Outcome
from plain_vmap import TOGETHER, fit_vmapped

from sysid.cli.workers import cores, prepare_worker
from sysid.data.loops import Loops
from sysid.fleet.chunks import chunk_jobs, fit_chunk
from sysid.fleet.fit import COARSE_STEPS, SCREEN_POINTS, fit_fleet
from sysid.fleet.slots import walk_all
from sysid.fleet.stack import Stack, stack_loops, thinned
from sysid.fleet.starts import fleet_starts
from sysid.identification.fit import fit_loops
from sysid.identification.multistart import WAVE
from sysid.jobs.cluster import Cluster
from sysid.jobs.run import run_jobs
from sysid.models.coordinates import place_of
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build
from sysid.trials.proportions import Share

TARGET_RATE, TARGET_SHARE = 50.0, 0.95
FEW: Final = 3
SAME: Final = 1e-6
VMAPPED: Final = 128
"""Dampers for the plain vmapped solver."""
JOB: Final = 50
"""Dampers of a Dask job."""


@dataclass
class Ran:
    """One method on (the first) dampers of a fleet.

    Attributes:
        name: In words.
        cost: N², of each damper.
        seconds: Wall time, compiled.
        busy: Processor time of this process; NaN where others worked.
        said: Dampers that it says have converged; -1 where it says nothing.
        notes: More numbers.
    """

    name: str
    cost: np.ndarray
    seconds: float
    busy: float
    said: int
    notes: dict[str, float]


def clocked(name: str, fit: Callable[[], tuple[np.ndarray, int, dict[str, float]]]) -> Ran:
    """Time something that is compiled already."""
    wall, busy = time.perf_counter(), time.process_time()
    cost, said, notes = fit()
    return Ran(
        name, cost, time.perf_counter() - wall, time.process_time() - busy, said, notes
    )  # fmt: skip


def batched(fleet: Sequence[Loops], starts: int, threads: int) -> Ran:
    """Ours."""

    def fit() -> tuple[np.ndarray, int, dict[str, float]]:
        found = fit_fleet(fleet, starts=starts, threads=threads)
        said = sum(result.name == "converged" for result in found.results)
        return found.cost, said, {
            "starts": float(found.starts.mean()), "steps": float(found.steps.mean()),
        }  # fmt: skip

    words = f"one batched program, {starts} starts"
    return clocked(f"{words}, {threads} threads" if threads > 1 else words, fit)


def alone(fleet: Sequence[Loops]) -> Ran:
    """Single fits, one after the other."""

    def fit() -> tuple[np.ndarray, int, dict[str, float]]:
        found = [fit_loops(loops) for loops in fleet]
        said = sum(one.result.name == "converged" for one in found)
        starts = float(np.mean([one.starts for one in found]))
        return np.array([one.cost for one in found]), said, {"starts": starts}

    return clocked("single fits in a loop", fit)


def vmapped(fleet: Sequence[Loops]) -> Ran:
    """The solver of single fits under `vmap`."""
    few = fleet[: min(VMAPPED, len(fleet)) // TOGETHER * TOGETHER]
    fit_vmapped(few[:TOGETHER])
    return clocked("plain vmapped solver, 8 starts", lambda: (fit_vmapped(few), -1, {}))


def on_dask(fleet: Sequence[Loops], starts: int) -> Ran:
    """Chunks of dampers as jobs on Dask workers that have compiled already."""
    names = [f"damper-{k:05d}" for k in range(len(fleet))]
    workers = cores()

    def run(cluster: Cluster, some: Sequence[Loops], size: int, file: Path) -> list[dict[str, Any]]:
        jobs = chunk_jobs(names[: len(some)], some, size=size, starts=starts)
        done = run_jobs(
            jobs, fit_chunk, cluster, file, lambda row: row.get("key"),
            prepare=prepare_worker, tell=lambda *_: None,
        )  # fmt: skip
        if done.failures:
            raise RuntimeError(f"jobs failed: {done.failures}")
        return [damper for job in jobs for damper in done.rows[job.key]["dampers"]]

    size = min(JOB, -(-len(fleet) // workers))
    with tempfile.TemporaryDirectory() as folder, Cluster(workers=workers) as cluster:
        run(cluster, fleet[: 2 * workers * size], size, Path(folder) / "warm.jsonl")
        begin = time.perf_counter()
        rows = run(cluster, fleet, size, Path(folder) / "rows.jsonl")
        seconds = time.perf_counter() - begin
    said = sum(row["result"] == "converged" for row in rows)
    cost = np.array([row["cost"] for row in rows])
    name = f"the same on Dask, {starts} starts, {workers} worker{'s' if workers > 1 else ''}"
    return Ran(name, cost, seconds, float("nan"), said, {})


def from_truth(dampers: Sequence[Damper], stack: Stack) -> np.ndarray:
    """Cost at the end of a descent from the truth, N²."""
    starts = []
    for k, damper in enumerate(dampers):
        reference = jax.tree.map(lambda z, k=k: z[k], stack.reference)
        coordinates = GeneralizedCoordinates(reference, "asymmetric")
        starts.append(np.asarray(place_of(coordinates, build(Generalized, damper.truth))))
    ends = walk_all(
        "asymmetric", stack, np.arange(len(dampers)), np.array(starts),
        tolerance=1e-10, max_steps=300, damping=1e-8,
    )  # fmt: skip
    return ends.cost * np.asarray(stack.scale)


def stages(fleet: Sequence[Loops], stack: Stack) -> dict[str, float]:
    """Where the time goes: ms a damper to stack and to start, µs a step, one core."""
    begin = time.process_time()
    stack_loops(fleet)
    stacked = time.process_time()
    first = fleet_starts(fleet, stack, "asymmetric")
    started = time.process_time()
    found = {
        "stack_ms": 1e3 * (stacked - begin) / len(fleet),
        "start_ms": 1e3 * (started - stacked) / len(fleet),
    }
    for part in (thinned(stack, SCREEN_POINTS), stack):
        begin = time.process_time()
        ends = walk_all(
            "asymmetric", part, np.arange(len(fleet)), first,
            tolerance=1e-4, max_steps=COARSE_STEPS, damping=1e-3,
        )  # fmt: skip
        found[f"step_us_{part.points}"] = 1e6 * (time.process_time() - begin) / ends.steps.sum()
    return found


def study(page: Outcome, count: int, scatter: float, words: str) -> None:
    """All methods on one fleet."""
    dampers = draw_dampers(count, scatter)
    fleet = [damper.loops for damper in dampers]
    for starts in (WAVE, FEW):
        fit_fleet(fleet[: min(count, 80)], starts=starts)
    fit_loops(fleet[0])
    ran = [batched(fleet, starts, 1) for starts in (WAVE, FEW)]
    if cores() > 1:
        ran += [batched(fleet, starts, cores()) for starts in (WAVE, FEW)]
    ran += [on_dask(fleet, WAVE), vmapped(fleet), alone(fleet)]
    stack = stack_loops(fleet)
    truth = from_truth(dampers, stack)
    best = np.minimum.reduce([truth, *(r.cost for r in ran if r.cost.size == count)])
    rows, numbers = [], {}
    for r in ran:
        excess = r.cost / best[: r.cost.size] - 1.0
        share = Share(int((excess <= NEAR).sum()), r.cost.size)
        rate, core = r.cost.size / r.seconds, r.cost.size / r.busy
        rows.append((
            r.name, f"{rate:.0f}", "–" if np.isnan(core) else f"{core:.0f}", share,
            f"{100 * np.mean(excess <= SAME):.1f} %",
            "–" if r.said < 0 else f"{r.said} of {r.cost.size}",
        ))  # fmt: skip
        numbers[r.name] = {
            "rate": rate, "rate_a_core": core, "share": share.as_dict(), "said": r.said,
            "largest_excess": float(excess.max()), "same": float(np.mean(excess <= SAME)),
            **r.notes,
        }  # fmt: skip
    page.lines += ["", f"## {words}"]
    page.table(
        (
            "method", "dampers a second", "a second of processor time",
            "at the optimum (95 % interval)", "within 10⁻⁶ of it", "said to have converged",
        ),
        rows,
    )  # fmt: skip
    spent = stages(fleet, stack)
    steps = ran[0].notes["steps"]
    page.say(
        f"Of the first line: {ran[0].notes['starts']:.1f} starts and {steps:.0f} steps a damper;",
        f"{spent['stack_ms']:.2f} ms to stack it, {spent['start_ms']:.2f} ms for its start;",
        f"{spent[f'step_us_{SCREEN_POINTS}']:.0f} µs a step of a start on {SCREEN_POINTS} points,",
        f"{spent[f'step_us_{POINTS}']:.0f} µs on all {POINTS}.",
    )
    page.numbers[words] = {"scatter": scatter, "methods": numbers, "stages": spent}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dampers", type=int, default=1000)
    parser.add_argument("--quick", action="store_true", help="64 dampers, nothing written")
    given = parser.parse_args()
    count = 64 if given.quick else max(given.dampers, TOGETHER)
    page = Outcome("fleet_batched", "Many dampers in one batched program")
    page.say(
        f"{count} dampers of ten designs (the three published sets and seven within ±30 % of one),",
        f"{len(PLAN)} conditions × 5 currents each, loops of {POINTS} points, noise 1 %, 16",
        "parameters, no start value.  At the optimum: cost within 0.1 % of the lowest known, of",
        "all methods and a descent from the truth.  All compiled before; loops in memory.",
        f"Targets: {TARGET_RATE:g} dampers a second on two cores, {100 * TARGET_SHARE:g} %.",
    )
    study(page, count, END_OF_LINE, "Every parameter even within ±20 % of the design")
    study(page, count, WIDE, "A harder case: ±50 %")
    page.say(
        f"The plain vmapped solver ran on the first {min(VMAPPED, count)} dampers, in batches of",
        f"{TOGETHER}: all its walks go on until the slowest has arrived.  Dask jobs have {JOB}",
        "dampers; their time includes sending loops and writing results.",
    )
    page.finish(keep=not given.quick)


if __name__ == "__main__":
    main()
