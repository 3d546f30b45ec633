"""How time and memory of a fit grow with the number of tests; one fresh process a size."""

import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from outcome import Outcome, arguments

if TYPE_CHECKING:
    from sysid.identification.problem import Problem
    from sysid.identification.result import Fit

SIZES: Final = (165, 1650, 16500)
STEPS: Final = 10
REPEATS: Final = 3
STEP_LIMIT, FIT_LIMIT, MEMORY_LIMIT = 1.2, 1.5, 3.0


def measure(tests: int) -> dict[str, float]:
    """Time a solver step and a whole fit, warm, and the peak memory of this process.

    Args:
        tests: How many.

    Returns:
        step: s, median of a Levenberg–Marquardt step on all data.
        fit: s, median of whole fits.
        cold: s, the first fit.
        memory: GB, peak of the process before and after nothing else than the fits.
        data: GB, of the loops' arrays.
    """
    from campaigns import draw_campaign, random_conditions

    from sysid.identification.fit import fit_loops
    from sysid.identification.problem import loop_problem

    conditions = random_conditions(tests, np.random.default_rng(tests))
    loops = draw_campaign(0, table="low", conditions=conditions).loops
    begin = time.perf_counter()
    fit = fit_loops(loops)
    cold = time.perf_counter() - begin
    fits = []
    for seed in range(1, REPEATS + 1):
        begin = time.perf_counter()
        fit_loops(loops, seed=seed)
        fits.append(time.perf_counter() - begin)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    arrays = (loops.displacement, loops.velocity, loops.acceleration, loops.force)
    return {
        "tests": tests,
        "step": _step_time(fit, loop_problem(loops)),
        "fit": float(np.median(fits)),
        "cold": cold,
        "memory": memory,
        "data": sum(a.nbytes for a in arrays) / 1e9,
    }


def _step_time(fit: "Fit", problem: "Problem") -> float:
    """Median time of a step of a descent that is not allowed to stop, on all data."""
    import equinox as eqx
    import jax.numpy as jnp

    from sysid.identification.levenberg_marquardt import descend
    from sysid.identification.multistart import BLOCK, in_blocks

    parts = (in_blocks(problem, BLOCK),)
    start = jnp.asarray(fit.u) + 0.3

    @eqx.filter_jit
    def run(coordinates, parts, start, steps):
        return descend(coordinates, parts, start, tolerance=-1.0, max_steps=steps)

    taken = 1 + STEPS
    seconds: dict[int, list[float]] = {1: [], taken: []}
    for repeat in range(REPEATS + 1):
        for steps, kept in seconds.items():
            begin = time.perf_counter()
            end = run(fit.coordinates, parts, start, steps)
            end.cost.block_until_ready()
            if repeat:
                kept.append(time.perf_counter() - begin)
            if int(end.steps) != steps:
                raise RuntimeError(f"the descent stopped after {int(end.steps)} of {steps} steps")
    return float(np.median(seconds[taken]) - np.median(seconds[1])) / (taken - 1)


def in_fresh_process(tests: int) -> dict[str, float]:
    """`measure` in a process of its own, so that its peak memory is that of one fit."""
    script = str(Path(__file__).resolve())
    command = [sys.executable, script, "--measure", str(tests)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    if sys.argv[1:2] == ["--measure"]:
        print(json.dumps(measure(int(sys.argv[2]))))
        return
    sizes, quick = arguments(__doc__ or "", len(SIZES), 2)
    found = [in_fresh_process(tests) for tests in SIZES[:sizes]]
    first = found[0]
    rows = []
    for one in found:
        linear = one["tests"] / first["tests"]
        rows.append((
            one["tests"], f"{1e3 * one['step']:.2f}", f"{one['step'] / first['step'] / linear:.2f}",
            f"{one['fit']:.2f}", f"{one['fit'] / first['fit'] / linear:.2f}",
            f"{one['cold']:.1f}", f"{one['memory']:.2f}", f"{one['data']:.3f}",
        ))  # fmt: skip
    outcome = Outcome("scaling", "Growth of time and memory")
    outcome.say(
        "Loops of 360 points on random conditions, 5 currents each, v_m ≤ 0.4 m/s, noise 1 %,",
        f"fit of 16 parameters without start; medians of {REPEATS}, compiled.  Each size runs in a",
        "fresh process, whose peak memory includes Python, JAX and the loops themselves (single",
        "cycles: cycle deviations are empty).",
    )
    outcome.table(
        (
            "tests", "ms a step", "over linear", "s a fit", "over linear", "s first fit",
            "peak GB", "loops GB",
        ),
        rows,
    )  # fmt: skip
    outcome.say(
        f"Targets: step ≤ {STEP_LIMIT} × linear, fit ≤ {FIT_LIMIT} × linear,",
        f"peak memory at 16 500 tests < {MEMORY_LIMIT:g} GB.",
    )
    outcome.numbers = {"sizes": found}
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
