"""Whether the lumped model's fit finds BS09's Table 1 again, how fast, and how sure it is."""

import time
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

import numpy as np
from outcome import Outcome, arguments
from sine_loops import sine_loops
from work_file import FOLDER, add_row, read_rows

from sysid.data.loops import Loops
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.models.lumped import CURRENTS, TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from sysid.parameters import as_dict, build
from sysid.trials.proportions import Share
from sysid.uncertainty.covariance import sandwich

EXCITATIONS: Final = ((0.010, 8.0), (0.005, 4.0))
"""m, Hz."""
TEMPERATURES: Final = tuple(np.arange(15.0, 76.0, 5.0).tolist())
POINTS: Final = 360
FEWER: Final = 72
"""Points a loop where many campaigns are fitted."""
NOISE: Final = 0.01
"""Of each test's RMS force, white, per sample."""
EXACT: Final = 5e-3
GOAL: Final = 60.0
"""s, warm, on two cores."""
REPEATS: Final = 3
WORK: Final = FOLDER / "lumped_recovery.jsonl"
"""Campaigns that are done, so that a stopped run goes on; delete it after a change of the fit."""


class Timed(NamedTuple):
    """A fit, and what it took: s of the clock, s of all processors."""

    fit: Fit
    wall: float
    cpu: float


def sweep(
    noise: float = 0.0,
    seed: int = 0,
    points: int = POINTS,
    currents: tuple[float, ...] = CURRENTS,
    temperatures: tuple[float, ...] = TEMPERATURES,
) -> Loops:
    """Loops of Table 1 as the model itself makes them: every current, temperature, excitation."""
    rows = [(a, f, i, t) for i in currents for t in temperatures for a, f in EXCITATIONS]
    amplitude, frequency, current, temperature = np.array(rows).T
    motion = sine_motion(amplitude, frequency, current, temperature, points)
    force = np.array(simulate(build(Lumped, TABLE_1), motion))
    rms = np.sqrt(np.mean(force**2, axis=1, keepdims=True))
    force += noise * rms * np.random.default_rng([20_090_000, seed]).standard_normal(force.shape)
    ids = [f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A_{t:g}C" for a, f, i, t in rows]
    return sine_loops(ids, motion, force, (amplitude, frequency, current, temperature))


def timed(loops: Loops, variant: str) -> Timed:
    """The whole of `fit_loops`: features, all starts, last descent, errors of every test."""
    wall, cpu = time.perf_counter(), time.process_time()
    fit = fit_loops(loops, model="lumped", variant=variant)
    return Timed(fit, time.perf_counter() - wall, time.process_time() - cpu)


def worst_error(fit: Fit) -> tuple[float, str]:
    """Largest error of a parameter, relative to that of Table 1, and whose it is."""
    return max((abs(z / TABLE_1[symbol] - 1.0), symbol) for symbol, z in as_dict(fit.valve).items())


def hits(loops: Loops) -> dict[str, bool]:
    """Symbol of each free parameter → its interval contains the truth; one wave of starts."""
    fit = fit_loops(loops, model="lumped", max_waves=1)
    return {
        p.symbol: bool(p.low <= TABLE_1[p.symbol] <= p.high)
        for p in sandwich(fit).parameters
        if p.symbol in fit.coordinates.free
    }


def covered(campaigns: int) -> Iterator[dict[str, bool]]:
    """`hits` of campaigns with noise, done earlier or now."""
    done: dict[int, Any] = {row["seed"]: row["hits"] for row in read_rows(WORK)}
    for seed in range(campaigns):
        if seed not in done:
            done[seed] = hits(sweep(NOISE, seed, FEWER))
            add_row({"seed": seed, "hits": done[seed]}, WORK)
        yield done[seed]


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", 200, 3)
    outcome = Outcome("lumped_recovery", "Recovery of BS09's Table 1 by the lumped model's fit")
    clean = sweep()
    outcome.say(
        f"{len(clean.ids)} loops of {POINTS} points: {len(CURRENTS)} currents,",
        f"{len(TEMPERATURES)} temperatures from 15 to 75 °C, 10 mm 8 Hz and 5 mm 4 Hz, simulated",
        "with Table 1 by the model itself. Fitted without a start value, weights as by default.",
    )
    rows, fits = [], {}
    for variant in ("paper", "full"):
        first, *warm = [timed(clean, variant) for _ in range(1 + (1 if quick else REPEATS))]
        error, symbol = worst_error(first.fit)
        wall, cpu = (float(np.median([getattr(t, z) for t in warm])) for z in ("wall", "cpu"))
        fits[variant] = {
            "worst": error, "symbol": symbol, "wall": wall, "cpu": cpu,
            "first_wall": first.wall, "starts": first.fit.starts, "result": first.fit.result.name,
        }  # fmt: skip
        rows.append((
            variant, len(first.fit.coordinates.free), f"{100 * error:.1g} ({symbol})",
            f"{wall:.1f}", f"{cpu:.1f}", f"{first.wall:.0f}", first.fit.starts,
        ))  # fmt: skip
    outcome.table(
        (
            "variant",
            "free",
            "worst error, % (of)",
            "warm, s",
            "processors, s",
            "first, s",
            "starts",
        ),
        rows,
    )
    outcome.say(
        f"Goals: at most {100 * EXACT:g} % without noise, {GOAL:g} s warm on two cores. Times are",
        "medians, of the clock and of all processors; the first fit includes compilation. In",
        "“paper” C_pre and m_l are those of the paper, which made the loops.",
    )
    found = list(covered(campaigns))
    share = pooled(found)
    outcome.say(
        f"{campaigns} campaigns of the same loops at {FEWER} points with white noise of 1 % of",
        f"each test's RMS force, variant “paper”, one wave of starts: {share} of the 95 %",
        "intervals (sandwich over tests) contain the truth (goal 90 to 98 %).",
    )
    symbols = list(found[0])
    by_symbol = {s: Share(sum(one[s] for one in found), campaigns) for s in symbols}
    outcome.table(("parameter", "intervals that contain the truth"), list(by_symbol.items()))
    outcome.say(
        "An interval is never narrower than independent noise would make it that is as large in",
        "each test as its own residuals. It is the larger of two estimates, and so covers a little",
        "more than 95 %.",
    )
    outcome.numbers = {
        "fits": fits, "campaigns": campaigns, "coverage": share.as_dict(),
        "by_symbol": {s: one.as_dict() for s, one in by_symbol.items()},
    }  # fmt: skip
    outcome.finish(keep=not quick)


def pooled(found: list[dict[str, bool]]) -> Share:
    """Of all parameters of all campaigns."""
    inside = [z for one in found for z in one.values()]
    return Share(sum(inside), len(inside))


if __name__ == "__main__":
    main()
