"""The physical damper: time of 165 tests, error against Radau, and SciPy's time for the same.

``python benchmarks/physical_damper.py`` writes results/physical_damper.{md,json};
``--quick`` runs 33 tests and one reference and writes nothing.
"""

import sys
import time
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from outcome import Outcome
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from sysid.rig.excitation import SineRun
from sysid.rig.physical.automotive import AUTOMOTIVE
from sysid.rig.physical.channels import low_pass
from sysid.rig.physical.course import POINTS, WORKERS, Outset, run_tests
from sysid.rig.physical.damper import PhysicalDamper
from sysid.rig.physical.equations import Drive, at_rest, balance
from sysid.rig.physical.magnet import after_history, field_yield_stress
from sysid.rig.physical.rd1005 import RD_1005
from sysid.rig.trial_matrix import CONDITIONS, CURRENTS

HALF = 0.5
"""Cycles of either ramp."""
CORNER = 250.0
"""Hz, of the force channel."""


@dataclass(frozen=True)
class Case:
    """A test that is compared: m, Hz, A."""

    name: str
    damper: PhysicalDamper
    amplitude: float
    frequency: float
    current: float

    @property
    def yield_stress(self) -> float:
        """At 40 °C after a virgin circuit was switched on, Pa."""
        d = self.damper
        field = after_history(
            d.magnet, float(d.valve.gap), float(d.oil.solids), np.array([[self.current]])
        )
        return float(field_yield_stress(field, float(d.oil.solids))[0])


CASES = (
    Case("automotive", AUTOMOTIVE, 12.5e-3, 2.5, 0.2),
    Case("automotive", AUTOMOTIVE, 2.5e-3, 10.0, 0.4),
    Case("automotive", AUTOMOTIVE, 25e-3, 0.5, 0.1),
    Case("RD-1005", RD_1005, 10e-3, 8.0, 1.0),
)


def main() -> None:
    quick = sys.argv[1:] == ["--quick"]
    page = Outcome("physical_damper", "The physical damper: time and error")
    page.say(
        "A monotube damper with its rig, thirteen unknowns a test, stepped by an L-stable implicit "
        f"method of second order with {POINTS} steps a cycle that lie closer about the reversals; "
        f"all tests side by side in float64, on {WORKERS} threads."
    )
    per_test = _time_of_matrix(page, quick)
    _errors(page, CASES[:1] if quick else CASES, per_test)
    page.finish(keep=not quick)


def _time_of_matrix(page: Outcome, quick: bool) -> float:
    """S for a test of four cycles."""
    settings = [(a, f, i) for a, fs in CONDITIONS for f in fs for i in CURRENTS][
        :: 5 if quick else 1
    ]
    a, f, i = np.array(settings).T
    d = AUTOMOTIVE
    field = after_history(d.magnet, float(d.valve.gap), float(d.oil.solids), i[None])
    outset = Outset(
        field_yield_stress(field, float(d.oil.solids)), i**2 * d.magnet.resistance,
        np.full_like(a, 40.0), np.full_like(a, 38.0),
    )  # fmt: skip
    runs = [
        SineRun(x, y, 0.0, (), 0.05, HALF, 4.0 - 2 * HALF, HALF) for x, y in zip(a, f, strict=True)
    ]
    seconds = []
    for _ in range(2):
        start = time.perf_counter()
        run_tests(d, runs, outset)
        seconds.append(time.perf_counter() - start)
    page.numbers |= {"tests": len(runs), "first_s": seconds[0], "again_s": seconds[1]}
    page.say(
        f"{len(runs)} tests of W11's Table 1, four cycles each: {seconds[0]:.1f} s with compiling, "
        f"{seconds[1]:.1f} s when it is compiled."
    )
    return seconds[1] / len(runs)


def _errors(page: Outcome, cases: tuple[Case, ...], per_test: float) -> None:
    rows, numbers = [], []
    for case in cases:
        grid = np.linspace(0.0, 1.5 / case.frequency, 6001)
        start = time.perf_counter()
        reference = _radau(case, grid, 1e-9)
        fine = time.perf_counter() - start
        start = time.perf_counter()
        loose = _radau(case, grid, 1e-4)
        coarse = time.perf_counter() - start
        own = {points: _own(case, grid, points) for points in (POINTS // 2, POINTS)}
        told = {
            "case": f"{case.name}, {1e3 * case.amplitude:g} mm {case.frequency:g} Hz "
            f"{case.current:g} A",
            "own_half": _against(own[POINTS // 2], reference, grid),
            "own": _against(own[POINTS], reference, grid),
            "loose": _against(loose, reference, grid),
            "radau_s": fine, "loose_s": coarse,
            "ratio": fine / 1.5 * 4.0 / per_test, "loose_ratio": coarse / 1.5 * 4.0 / per_test,
        }  # fmt: skip
        numbers.append(told)
        rows.append(
            [told["case"], *(_percent(told[k]) for k in ("own_half", "own", "loose")),
             f"{fine:.1f} s", f"{told['ratio']:.0f}", f"{told['loose_ratio']:.0f}"]
        )  # fmt: skip
    page.numbers["cases"] = numbers
    page.say(
        "Error of the force against SciPy's Radau at 1e-9 over the second half cycle to the end of "
        "the third, in % of the largest force: RMS / largest, and after the slash the RMS behind "
        f"the force channel's filter of {CORNER:g} Hz. The largest errors are those of the ringing "
        "of piston and mounts at some hundred Hz after a reversal. The ratios are Radau's time for "
        "a test of four cycles over ours in the batch, in the same run, at 1e-9 and at 1e-4."
    )
    page.table(
        ["test", f"{POINTS // 2} steps", f"{POINTS} steps", "Radau 1e-4", "Radau, 1.5 cycles",
         "ratio at 1e-9", "ratio at 1e-4"],
        rows,
    )  # fmt: skip


def _percent(errors: dict[str, float]) -> str:
    return f"{errors['rms']:.3f} / {errors['largest']:.2f}, {errors['filtered']:.3f}"


def _against(force: np.ndarray, reference: np.ndarray, grid: np.ndarray) -> dict[str, float]:
    late = grid >= HALF / 1.5 * grid[-1]
    peak = float(np.max(np.abs(reference)))
    rate = 1.0 / (grid[1] - grid[0])
    error = force - reference
    behind = low_pass(error, CORNER, rate) if 0.4 * rate > CORNER else error
    rms = lambda x: 100.0 * float(np.sqrt(np.mean(x[late] ** 2))) / peak  # noqa: E731
    largest = 100.0 * float(np.max(np.abs(error[late]))) / peak
    return {"rms": rms(error), "largest": largest, "filtered": rms(behind)}


def _own(case: Case, grid: np.ndarray, points: int) -> np.ndarray:
    run = SineRun(case.amplitude, case.frequency, 0.0, (), 0.05, HALF, HALF, HALF)
    one = np.ones(1)
    outset = Outset(case.yield_stress * one, 0.0 * one, 40.0 * one, 38.0 * one)
    course = run_tests(case.damper, [run], outset, points)
    return PchipInterpolator(course.time[:, 0], course.force[:, 0])(grid)


def _radau(case: Case, grid: np.ndarray, tolerance: float) -> np.ndarray:
    f, stress = case.frequency, jnp.asarray(case.yield_stress)

    def motion(t: Any) -> jax.Array:
        turns = t * f
        rise = 0.5 * (1.0 - jnp.cos(jnp.pi * jnp.clip(turns / HALF, 0.0, 1.0)))
        fall = 0.5 * (1.0 - jnp.cos(jnp.pi * jnp.clip((1.5 - turns) / HALF, 0.0, 1.0)))
        return case.amplitude * rise * fall * jnp.sin(2.0 * jnp.pi * turns)

    @jax.jit
    def rate(y: jax.Array, t: Any) -> jax.Array:
        drive = Drive(motion(t), jax.grad(motion)(t), stress, jnp.asarray(0.0))
        held = jax.jacfwd(lambda x: balance(case.damper, x, drive)[0])(y)
        return jnp.linalg.solve(held, balance(case.damper, y, drive)[1])

    slope = jax.jit(jax.jacfwd(rate))
    start = np.asarray(at_rest(case.damper, *(jnp.asarray(x) for x in (0.0, 40.0, 38.0))))
    for compiled in (rate, slope):
        compiled(start, 0.0)
    solved = solve_ivp(
        lambda t, y: np.asarray(rate(y, t)), (0.0, grid[-1]), start, "Radau", grid,
        rtol=tolerance, atol=tolerance, jac=lambda t, y: np.asarray(slope(y, t)),
        max_step=0.02 / f,
    )  # fmt: skip
    still = Drive(*(jnp.asarray(0.0) for _ in Drive._fields))
    force = jax.vmap(lambda y: balance(case.damper, y, still)[2].force, 1)
    return np.asarray(force(jnp.asarray(solved.y)))


if __name__ == "__main__":
    main()
