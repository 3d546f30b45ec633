"""The isolator study: its errors and its speed beside SciPy's, and what the paper says of it."""

import time
from collections.abc import Callable
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from isolator_paper import TEMPERATURES, VALVE, against_paper, car, gas, rig, run, sweeps, worth
from isolator_reference import Isolator, continuous_run, law, sampled_run
from outcome import Outcome, arguments
from scipy.interpolate import CubicSpline

from sysid.isolator.base_motion import BaseMotion, butterworth_motion
from sysid.isolator.closed_loop import CLOCK, Clock, sampled, trace
from sysid.isolator.families import Name, family
from sysid.isolator.lumped_step import lumped_step
from sysid.isolator.plant import MASS, NATURAL_FREQUENCY, mass_isolator
from sysid.isolator.study import ConflictDiagram

Case = tuple[Name, float, float]
CASES: Final[tuple[Case, ...]] = (
    ("P", 2000.0, 15.0), ("PID", 2000.0, 75.0), ("GS", 5000.0, 45.0), ("OO", 0.2, 75.0),
)  # fmt: skip
"""Runs that are held against SciPy: controller, set point, °C."""
SECONDS: Final = 1.0
STEPS: Final = (4, 8, 16)
ALLOWED: Final = 1e-3
"""Error of an RMS value that SciPy is allowed where its speed is measured."""
PEERS: Final = {"LSODA": (1e-3, 1e-4, 1e-5), "BDF": (1e-3, 1e-4), "Radau": (1e-2, 1e-3)}
EXACT: Final = ("LSODA", 1e-7)
STIFFNESS: Final = MASS * (2.0 * np.pi * NATURAL_FREQUENCY) ** 2

_followed = jax.jit(trace, static_argnums=4)


def main() -> None:
    motions, quick = arguments(__doc__ or "", 20, 2)
    outcome = Outcome("isolator", "A damper in an isolator: BS09's Table 1 under skyhook control")
    base = butterworth_motion(range(1, motions + 1))
    seconds, diagram = speed(outcome, base)
    parts: tuple[Callable[[], None], ...] = (
        lambda: accuracy(outcome),
        lambda: peers(outcome, seconds, diagram.runs),
        lambda: against_paper(outcome, diagram, base),
        lambda: sweeps(outcome, motions),
        lambda: car(outcome, motions),
        lambda: rig(outcome, base),
        lambda: gas(outcome, base),
        lambda: worth(outcome, base),
    )
    for part in parts:
        begin = time.perf_counter()
        part()
        print(f"… {time.perf_counter() - begin:.0f} s", flush=True)
    outcome.finish(keep=not quick)


def speed(outcome: Outcome, base: BaseMotion) -> tuple[float, ConflictDiagram]:
    """Controllers × set points × temperatures × motions, cold and warm."""
    begin = time.perf_counter()
    diagram = run(base, temperatures=TEMPERATURES)
    cold = time.perf_counter() - begin
    begin = time.perf_counter()
    run(base, temperatures=TEMPERATURES)
    warm = time.perf_counter() - begin
    outcome.say(
        f"{diagram.runs} runs of {base.duration:g} s (4 controllers, 9 set points,",
        f"{len(TEMPERATURES)} temperatures, {base.displacement.shape[0]} motions of the base):",
        f"{warm:.1f} s warm, {cold:.1f} s with compiling.  Controllers sample at",
        f"{1e-3 / CLOCK.period:g} kHz; steps of {1e3 * CLOCK.step:g} ms in between.",
    )
    outcome.numbers["study"] = {"runs": diagram.runs, "warm_s": warm, "cold_s": cold}
    return warm, diagram


def accuracy(outcome: Outcome) -> None:
    """The same sampled loops by Radau at 1e-8."""
    base = butterworth_motion([1], duration=SECONDS)
    spline, count = spline_of(base), round(SECONDS / CLOCK.period)
    rows, numbers = [], []
    for case in CASES:
        kind, setting, t = case
        plant = Isolator(MASS, STIFFNESS, t)
        exact = sampled_run(
            plant, law(kind, setting), spline, CLOCK.period, count, rtol=1e-8, atol=1e-11
        )
        cells = []
        for steps in STEPS:
            errors = _errors(case, base, steps, exact, spline)
            cells.append(", ".join(f"{100 * e:.2g}" for e in errors))
            names = ("force", "rms_acceleration", "rms_working_space")
            numbers.append(
                {"controller": kind, "degC": t, "steps": steps}
                | dict(zip(names, errors, strict=True))
            )
        rows.append((kind, f"{setting:g}", f"{t:g}", *cells))
    outcome.say(
        f"Error of {SECONDS:g} s against SciPy's Radau (rtol 1e-8) from sample to sample of the",
        "same controllers, per cent: largest force, RMS acceleration, RMS working space; steps a",
        f"sample, of which the study has {CLOCK.steps}.",
    )
    head = ("controller", "set point", "°C", *(f"{n} steps" for n in STEPS))
    outcome.table(head, rows)
    outcome.numbers["errors"] = numbers


def _errors(
    case: Case, base: BaseMotion, steps: int, exact: np.ndarray, spline: CubicSpline
) -> tuple[float, float, float]:
    kind, setting, t = case
    clock = Clock(CLOCK.period, steps)
    many = (sampled(base, clock), family(kind, VALVE, set_points=(setting,)).controllers)
    one, controller = jax.tree.map(lambda z: z[0], many)
    found = _followed(mass_isolator(), lumped_step(VALVE, jnp.asarray(t)), controller, one, clock)
    force = k_of(t) * exact[:, 2]
    worst = float(np.abs(np.asarray(found.force) - force).max() / np.abs(force).max())
    mine = (
        float(np.sqrt(np.mean(np.asarray(z) ** 2)))
        for z in (found.acceleration, found.working_space)
    )
    theirs = rms(exact, t, spline)
    acceleration, space = (abs(a / b - 1.0) for a, b in zip(mine, theirs, strict=True))
    return worst, acceleration, space


def peers(outcome: Outcome, seconds: float, runs: int) -> None:
    """What SciPy needs for some of the runs, in the form that suits it best: without samples."""
    spline = spline_of(butterworth_motion([1], duration=SECONDS))
    cases = [c for c in CASES if c[0] != "PID"]
    exact = {c: rms(continuous(c, spline, *EXACT)[0], c[2], spline) for c in cases}
    rows, good = [], {}
    for method, tolerances in PEERS.items():
        for tolerance in tolerances:
            errors, spent = [], 0.0
            for case in cases:
                states, took = continuous(case, spline, method, tolerance)
                spent += took
                mine = rms(states, case[2], spline)
                errors += [abs(a / b - 1.0) for a, b in zip(mine, exact[case], strict=True)]
            each = spent / len(cases) / SECONDS * 5.0
            error = f"{100 * max(errors):.2g}"
            rows.append((method, f"{tolerance:g}", error, f"{each:.2f}", f"{each * runs:.0f}"))
            if max(errors) <= ALLOWED:
                good[f"{method} at rtol {tolerance:g}"] = each * runs
    outcome.say(
        "SciPy's `solve_ivp` on three of these runs (P, GS, OO) with controllers that act at every",
        "instant, which spares it all restarts: largest error of an RMS value, s for 5 s,",
        f"extrapolated to {runs} runs.",
    )
    outcome.table(("method", "rtol", "error, %", "s a run", "s for all"), rows)
    if good:
        best = min(good, key=lambda name: good[name])
        ratio = good[best] / seconds
        outcome.say(
            f"Fastest with an error of at most {100 * ALLOWED:g} %: {best}, {good[best]:.0f} s:",
            f"the study is {ratio:.0f} times faster.",
        )
        outcome.numbers["faster_than_solve_ivp"] = ratio
        outcome.numbers["solve_ivp"] = {"fastest": best, "s": good[best]}


def continuous(
    case: Case, spline: CubicSpline, method: str, tolerance: float
) -> tuple[np.ndarray, float]:
    """States at the samples, and how long it took."""
    kind, setting, t = case
    at = CLOCK.period * np.arange(round(SECONDS / CLOCK.period))
    plant, begin = Isolator(MASS, STIFFNESS, t), time.perf_counter()
    states = continuous_run(
        plant, law(kind, setting), spline, at, method=method, rtol=tolerance, atol=1e-4 * tolerance
    )
    return states, time.perf_counter() - begin


def spline_of(base: BaseMotion) -> CubicSpline:
    """The motion of the base, as both sides see it."""
    grid = base.interval * np.arange(base.displacement.shape[1])
    ends = ((1, 0.0), (2, 0.0))
    return CubicSpline(grid, base.displacement[0], bc_type=ends)  # type: ignore[arg-type]  # as its manual has it


def k_of(temperature: float) -> float:
    """Stiffness of Table 1, N/m."""
    return 1e3 * (1500.0 + 150.0 * temperature)


def rms(states: np.ndarray, temperature: float, spline: CubicSpline) -> tuple[float, float]:
    """RMS acceleration and working space of SciPy's states at the samples."""
    space = spline(CLOCK.period * np.arange(states.shape[0])) - states[:, 0]
    acceleration = (STIFFNESS * space + k_of(temperature) * states[:, 2]) / MASS
    return float(np.sqrt(np.mean(acceleration**2))), float(np.sqrt(np.mean(space**2)))


if __name__ == "__main__":
    main()
