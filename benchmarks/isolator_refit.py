"""What a refitted table is worth to gain scheduling on a damper whose force knows frequency.

``python benchmarks/isolator_refit.py`` writes results/isolator_refit.{md,json}; ``--quick`` has two
motions and one law of frequency and writes nothing.
"""

import sys
import time
from dataclasses import dataclass
from typing import Final

import numpy as np
from isolator_paper import VALVE, told
from outcome import Outcome, arguments
from sine_loops import sine_loops

from sysid.data.loops import Loops
from sysid.effects.law.frequency_law import FrequencyLaw
from sysid.effects.registry import make
from sysid.identification.fit import fit_loops
from sysid.isolator.base_motion import BaseMotion, butterworth_motion
from sysid.isolator.compare import Band, band, rival
from sysid.isolator.families import Family, Gains, table_of
from sysid.isolator.plant import mass_isolator
from sysid.isolator.worth import Worth, scheduled, worth_of_tables
from sysid.models.damper import Damper
from sysid.models.lumped import CURRENTS, TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from sysid.parameters import as_dict

PER_DECADE: Final = (-0.3, -0.1, 0.0, 0.1, 0.3)
EXCITATIONS: Final = ((0.010, 8.0), (0.005, 4.0))
"""m, Hz: the paper's two."""
TEMPERATURES: Final = (15.0, 45.0, 75.0)
POINTS: Final = 72
NOISE: Final = 0.01
"""Of each test's RMS force, white, per sample."""
LOOP: Final = 5.0
"""Hz at which the isolator moves, where the extended card's table is read."""
WARM: Final = Gains(temperature=75.0)
DAMPING: Final = 3500.0
"""D of gain scheduling that the paper shows, N·s/m."""
SHOWN: Final = (0.2, 1.0)
"""A, at which tables are compared."""


@dataclass(frozen=True)
class Case:
    """A law of frequency, the base card fitted to tests with it, and what tables make of it.

    Attributes:
        per_decade: ε.
        fitted: The lumped model as identified.
        error: Mean RMSE/max|F| of the fit.
        wrong: Force of its table over that of the extended card, less 1, at `SHOWN`.
        cold: On the damper at 15 °C.
        warm: At 75 °C.
    """

    per_decade: float
    fitted: Lumped
    error: float
    wrong: tuple[float, ...]
    cold: Worth
    warm: Worth


def tests(per_decade: float) -> Loops:
    """The paper's excitations on Table 1 with the law of frequency, by the extended card."""
    rows = [(a, f, i, t) for i in CURRENTS for t in TEMPERATURES for a, f in EXCITATIONS]
    amplitude, frequency, current, temperature = np.array(rows).T
    motion = sine_motion(amplitude, frequency, current, temperature, POINTS)
    extended = Damper(VALVE, (make(FrequencyLaw, per_decade),))
    force = np.array(simulate(extended, motion))
    rms = np.sqrt(np.mean(force**2, axis=1, keepdims=True))
    force += NOISE * rms * np.random.default_rng(20_090_003).standard_normal(force.shape)
    ids = [f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A_{t:g}C" for a, f, i, t in rows]
    return sine_loops(ids, motion, force, (amplitude, frequency, current, temperature))


def at_loop(per_decade: float) -> float:
    """The extended card's factor where the isolator moves."""
    return 1.0 + per_decade * float(np.log10(LOOP))


def case(per_decade: float, base: BaseMotion) -> Case:
    """Fit the base, make tables, isolate."""
    loops = tests(per_decade)
    fit = fit_loops(loops, model="lumped", max_waves=1)
    fitted, right = fit.valve, at_loop(per_decade)
    assert isinstance(fitted, Lumped)
    believed, currents = table_of(fitted)
    true = right * table_of(VALVE)[0]
    wrong = tuple(float(np.interp(i, currents, believed / true - 1.0)) for i in SHOWN)
    tables = [
        scheduled(fitted, "base"),
        scheduled(VALVE, "extended", yielding=right, post=right),
        scheduled(fitted, "base, 75 °C", WARM),
        scheduled(VALVE, "extended, 75 °C", WARM, yielding=right, post=right),
    ]
    cold, warm = (isolated(tables, base, t, per_decade) for t in (15.0, 75.0))
    return Case(per_decade, fitted, fit.mean_nrmse, wrong, cold, warm)


def isolated(
    tables: list[Family], base: BaseMotion, temperature: float, per_decade: float
) -> Worth:
    """P, PID and the tables on the damper with the law."""
    return worth_of_tables(
        mass_isolator(), VALVE, tables, base, temperature=temperature, per_decade=per_decade
    )


def back(worth: Worth, suffix: str = "") -> Band | None:
    """Extended over base at equal working space."""
    found = rival(worth.diagram, f"extended{suffix}", f"base{suffix}", 0)
    return None if found is None else found.excess


def at_one_damping(worth: Worth) -> tuple[Band, Band]:
    """Extended over base at the same D: acceleration, working space."""
    one, other = (worth.diagram.curve(name) for name in ("extended", "base"))
    at = one.set_points.index(DAMPING)
    pairs = (
        (one.acceleration, other.acceleration), (one.working_space, other.working_space),
    )  # fmt: skip
    acceleration, space = (band(a[at, 0] / b[at, 0] - 1.0) for a, b in pairs)
    return acceleration, space


def page(cases: list[Case]) -> Outcome:
    """All of it."""
    outcome = Outcome(
        "isolator_refit", "Gain scheduling on a damper whose force depends on frequency"
    )
    outcome.say(
        f"BS09's damper with F (1 + ε log₁₀(f / 1 Hz)).  {len(EXCITATIONS) * 18} tests on the",
        "paper's two excitations (10 mm 8 Hz, 5 mm 4 Hz; 15, 45 and 75 °C; 0 to 1 A; 1 % noise)",
        "are made by the card with the law, and the lumped base is fitted to them by `fit_loops`,",
        "as `sysid fit` does.  Force in its table for gain scheduling (15 °C) over that of the",
        f"extended card at {LOOP:g} Hz:",
    )
    head = ("ε", "error of the fit", *(f"table at {i:g} A" for i in SHOWN))
    rows = [
        (f"{100 * c.per_decade:+g} %", f"{c.error:.2%}", *(f"{100 * z:+.1f} %" for z in c.wrong))
        for c in cases
    ]
    outcome.table(head, rows)
    for words, name in (("15 °C", "cold"), ("75 °C", "warm")):
        outcome.say(
            f"The damper at {words} in the isolator: RMS acceleration over that of P at equal",
            "working space, and extended over base table, in per cent with 95 % intervals over",
            "base motions.",
        )
        names = ("PID", "base", "extended", "base, 75 °C", "extended, 75 °C")
        table = []
        for c in cases:
            worth: Worth = getattr(c, name)
            by = {r.name: told(r.excess) for r in worth.over_p}
            pairs = [back(worth), back(worth, ", 75 °C")]
            cells = ["" if b is None else finely(b) for b in pairs]
            table.append((f"{100 * c.per_decade:+g} %", *(by.get(n, "") for n in names), *cells))
        last = ("extended / base", "the same, tables at 75 °C")
        outcome.table(("ε", *names, *last), table)
    outcome.say(
        f"At one D, {DAMPING / 1e3:g} kN·s/m, where a table that is wrong by a factor is another",
        "point of the same curve: extended over base, per cent.",
    )
    fixed = []
    for c in cases:
        cells = [finely(b) for w in (c.cold, c.warm) for b in at_one_damping(w)]
        fixed.append((f"{100 * c.per_decade:+g} %", *cells))
    outcome.table(
        ("ε", "acceleration, 15 °C", "working space, 15 °C", "acceleration, 75 °C",
         "working space, 75 °C"), fixed,
    )  # fmt: skip
    outcome.numbers["cases"] = [numbers(c) for c in cases]
    return outcome


def finely(found: Band) -> str:
    """Per cent, two decimals."""
    value, low, high = (100 * z for z in (found.value, found.low, found.high))
    return f"{value:+.2f} ({low:+.2f} … {high:+.2f})"


def numbers(c: Case) -> dict[str, object]:
    """For JSON."""
    found: dict[str, object] = {
        "per_decade": c.per_decade, "fit_nrmse": c.error, "table_over_extended": c.wrong,
        "fitted": {k: float(v) for k, v in as_dict(c.fitted).items()}, "table_1": dict(TABLE_1),
    }  # fmt: skip
    for name, worth in (("15 °C", c.cold), ("75 °C", c.warm)):
        pairs = {"tables at 15 °C": back(worth), "tables at 75 °C": back(worth, ", 75 °C")}
        found[name] = {
            "over_P": {r.name: vars(r.excess) for r in worth.over_p},
            "extended_over_base": {k: None if b is None else vars(b) for k, b in pairs.items()},
            "at_one_damping": [vars(b) for b in at_one_damping(worth)],
        }
    return found


def main() -> None:
    motions, quick = arguments(__doc__ or "", 20, 2)
    base = butterworth_motion(range(1, motions + 1))
    cases = []
    for per_decade in PER_DECADE[-1:] if quick else PER_DECADE:
        begin = time.perf_counter()
        cases.append(case(per_decade, base))
        print(f"{per_decade:+g}: {time.perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)
    page(cases).finish(keep=not quick)


if __name__ == "__main__":
    main()
