"""Error and time of the lumped model's solver, beside SciPy's, in one run."""

import time
from importlib.util import find_spec
from typing import Final, NamedTuple

import numpy as np
from lumped_reference import CURRENTS, EXCITATIONS, TEMPERATURES, steady_force
from outcome import Outcome, arguments

from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion, sine_motion
from sysid.parameters import build

POINTS: Final = 720
"""Of the reference, a cycle; every grid that is tried takes some of them."""
GRIDS: Final = (24, 48, 72, 144, 360, 720)
PEER_POINTS: Final = 72
"""Points a cycle at which SciPy is asked for the force."""
ALLOWED: Final = 1e-3
"""Error in parts of max|F|."""
GOAL: Final = 100.0
TOLERANCES: Final = {
    "LSODA": (1e-2, 1e-3, 1e-4, 5e-5, 2e-5, 1e-5, 1e-6),
    "Radau": (1e-2, 1e-3, 1e-4),
    "BDF": (1e-3, 1e-4, 1e-5),
}
DIFFRAX: Final = {
    "Tsit5": (1e-3, 1e-4, 1e-5),
    "Kvaerno3": (1e-3, 1e-4, 1e-5, 1e-6),
    "Kvaerno5": (1e-3, 1e-4, 1e-5, 1e-6),
}
CYCLES: Final = 2
"""What the others run, from a start as good as ours: the first to forget it, the second to keep."""
REPEATS: Final = 25
FEWER_REPEATS: Final = 3

Conditions = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


class Measured(NamedTuple):
    """Cost and accuracy of one way to solve it.

    Attributes:
        errors: Largest difference from the reference in parts of max|F|, [loops].
        seconds: A loop, warm.
    """

    errors: np.ndarray
    seconds: float

    @property
    def worst(self) -> float:
        """Largest error of all loops."""
        return float(self.errors.max())


def conditions(currents: int = len(CURRENTS)) -> Conditions:
    """Amplitude, frequency, current and temperature of every loop."""
    kept = np.array(CURRENTS)[np.linspace(0, len(CURRENTS) - 1, currents).round().astype(int)]
    rows = [(a, f, i, t) for a, f in EXCITATIONS for i in kept for t in TEMPERATURES]
    amplitude, frequency, current, temperature = np.array(rows).T
    return amplitude, frequency, current, temperature


def reference(loops: Conditions) -> np.ndarray:
    """Radau at a tolerance of 1e-8, [loops, POINTS]."""
    return np.array([steady_force(*row, POINTS) for row in zip(*loops, strict=True)])


def errors(force: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Largest difference in parts of max|F|, [loops]."""
    every = exact.shape[1] // force.shape[1]
    return np.abs(force - exact[:, ::every]).max(axis=1) / np.abs(exact).max(axis=1)


def ours(loops: Conditions, points: int, exact: np.ndarray) -> Measured:
    """All loops at once, compiled before; median of some runs."""
    valve, motion = build(Lumped, TABLE_1), sine_motion(*loops, points=points)
    force = np.asarray(simulate(valve, motion))
    seconds = [_timed(valve, motion) for _ in range(REPEATS)]
    return Measured(errors(force, exact), float(np.median(seconds)) / force.shape[0])


def scipys(loops: Conditions, method: str, tolerance: float, exact: np.ndarray) -> Measured:
    """One loop after the other by `solve_ivp`."""
    rows = list(zip(*loops, strict=True))
    begin = time.perf_counter()
    force = [
        steady_force(
            *row, PEER_POINTS, cycles=CYCLES, method=method, rtol=tolerance, atol=1e-4 * tolerance
        )
        for row in rows
    ]
    seconds = (time.perf_counter() - begin) / len(rows)
    return Measured(errors(np.array(force), exact), seconds)


def diffraxes(loops: Conditions, name: str, tolerance: float, exact: np.ndarray) -> Measured:
    """All loops at once, compiled before; median of some runs."""
    from lumped_diffrax import solver_of

    run = solver_of(loops, PEER_POINTS, name, tolerance, CYCLES)
    force = np.asarray(run())
    seconds = []
    for _ in range(FEWER_REPEATS):
        begin = time.perf_counter()
        run().block_until_ready()
        seconds.append(time.perf_counter() - begin)
    return Measured(errors(force, exact), float(np.median(seconds)) / force.shape[0])


def _timed(valve: Lumped, motion: Motion) -> float:
    begin = time.perf_counter()
    simulate(valve, motion).block_until_ready()
    return time.perf_counter() - begin


def main() -> None:
    kept, quick = arguments(__doc__ or "", len(CURRENTS), 2)
    loops = conditions(kept)
    exact = reference(loops)
    outcome = Outcome("lumped_solver", "The lumped model's solver: accuracy and cost")
    outcome.say(
        f"{exact.shape[0]} loops of BS09's Table 1 (currents of the table, 15, 45 and 75 °C, 10 mm",
        "8 Hz and 5 mm 4 Hz).  Error: largest difference in a loop from Radau at rtol 1e-8, in",
        "per cent of max|F|.  Ours solves all loops at once for their periodic orbit, compiled;",
        f"SciPy runs {CYCLES} cycles of one loop after the other, from the same start, atol =",
        "1e-4 rtol in m and m/s, and is given the Jacobian"
        + (
            "; diffrax the same for all loops at once, compiled, each loop with steps of its own."
            if find_spec("diffrax")
            else "."
        ),
    )
    rows, numbers = [], {}
    for points in GRIDS:
        one = ours(loops, points, exact)
        numbers[f"ours {points}"] = one
        rows.append(("piecewise exact", f"{points} points", *_cells(one)))
    for method, tolerances in TOLERANCES.items():
        for tolerance in tolerances:
            one = scipys(loops, method, tolerance, exact)
            numbers[f"{method} {tolerance:g}"] = one
            rows.append((f"SciPy {method}", f"rtol {tolerance:g}", *_cells(one)))
    for name, tolerances in DIFFRAX.items():
        for tolerance in tolerances if find_spec("diffrax") else ():
            one = diffraxes(loops, name, tolerance, exact)
            numbers[f"diffrax {name} {tolerance:g}"] = one
            rows.append((f"diffrax {name}", f"rtol {tolerance:g}", *_cells(one)))
    head = ("solver", "setting", "worst error, %", "median error, %", "ms a loop")
    outcome.table(head, rows)
    chosen, peer = (_fastest(numbers, name) for name in ("ours", "LSODA"))
    ratio = numbers[peer].seconds / numbers[chosen].seconds
    outcome.say(
        f"Fastest with an error of at most {100 * ALLOWED:g} %: {peer.replace(' ', ' at rtol ')},",
        f"{1e3 * numbers[peer].seconds:.1f} ms a loop; {chosen} points,",
        f"{1e3 * numbers[chosen].seconds:.3f} ms: {ratio:.0f} times faster (goal {GOAL:g};",
        f"{ratio / CYCLES:.0f} times, if only one of the cycles that SciPy needs is counted).",
    )
    if find_spec("diffrax"):
        near = _fastest(numbers, "diffrax")
        against = numbers[near].seconds / numbers[chosen].seconds
        outcome.say(
            f"Of diffrax the fastest with such an error: {near},",
            f"{1e3 * numbers[near].seconds:.2f} ms: {against:.0f} times as long as ours.",
        )
        outcome.numbers["faster_than_diffrax"] = against
    outcome.numbers["faster"] = ratio
    outcome.numbers["solvers"] = {
        name: {"worst": one.worst, "median": float(np.median(one.errors)), "seconds": one.seconds}
        for name, one in numbers.items()
    }
    outcome.finish(keep=not quick)


def _fastest(numbers: dict[str, Measured], solver: str) -> str:
    """The cheapest setting of a solver that is accurate enough."""
    allowed = [n for n, one in numbers.items() if n.startswith(solver) and one.worst <= ALLOWED]
    return min(allowed, key=lambda name: numbers[name].seconds)


def _cells(one: Measured) -> tuple[str, str, str]:
    worst, median = 100 * one.worst, 100 * np.median(one.errors)
    return f"{worst:.2g}", f"{median:.2g}", f"{1e3 * one.seconds:.2f}"


if __name__ == "__main__":
    main()
