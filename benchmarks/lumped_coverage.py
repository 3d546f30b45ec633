"""How often 95 % intervals of the lumped model's parameters contain the truth, laws right or wrong.

BS09's sweep with errors of the rig; laws that are wrong bend over temperature, from current to
current alike and anew, and over velocity.  Every finished campaign is one line of a work file, so
that a study goes on where it was.
"""

import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from interval_rows import BAND, HOLDS, OPEN, Interval, Told, told
from outcome import RESULTS, Outcome
from study import run_study, study_parser
from work_file import FOLDER, read_rows

from sysid.jobs.job import Ended
from sysid.jobs.rows import shortened
from sysid.trials.program import fingerprint

if TYPE_CHECKING:
    from lumped_campaign import Conditions

    from sysid.data.loops import Loops

MISFITS: Final = (0.0, 2.0)
"""RMS that the refitted model leaves of a perfect measurement, % of the RMS force."""
CAMPAIGNS: Final = 100
"""Of each misfit."""
FIRST_SEED: Final = 63_000_000
TEMPERATURES: Final = (15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0)
"""°C."""
GAIN, OFFSET, DELAY, THERMOMETER, NOISE = 6e-3, 2.0, 1e-4, 0.3, 0.01
"""Errors of the rig: of the load cell, N, s, K; noise of a cycle in parts of max|F|."""
START: Final = 0.03
"""Size of the laws' errors that is tried first."""
CLOSE: Final = 0.03
_ROUNDS: Final = 6
WORK: Final = RESULTS / "lumped_coverage.jsonl"
PROGRAM: Final = fingerprint(
    ("arrays.py", "data", "effects", "identification", "likelihood", "models", "motion",
     "parameters.py", "uncertainty", "units.py"),
)  # fmt: skip
"""Rows count for the program that fitted and told the intervals."""
CARD: Final = "eq_11"
KINDS: Final = {
    "eq_11": "values of Eq. 11 under Σ, along profiles (the card's)",
    "eq_11_straight": "the same, ± t standard errors",
    "gls": "values of GLS, ± t standard errors",
    "tests": "values of Eq. 11, sandwich over tests",
    "independent": "the same, independent points",
}


@dataclass(frozen=True)
class Departure:
    """How a damper's laws depart from straight lines in temperature and velocity.

    Attributes:
        common: [3, 2] of C_post, F_y and k: bend and double bend over the range of temperature.
        own: [2, 6, 2] the same, of C_post and F_y at each current.
        velocity: Of the viscous force: bend over velocity.
    """

    common: np.ndarray
    own: np.ndarray
    velocity: float

    def loops(self, tests: "Conditions", size: float) -> "Loops":
        """Clean steady loops of the damper, its laws wrong by so much."""
        from lumped_campaign import CURRENTS, names, table_1
        from sine_loops import sine_loops

        from sysid.models.lumped import element_force
        from sysid.motion.motion import sine_motion

        motion = sine_motion(*tests, points=360)
        element = table_1().element(motion)
        z = (tests.temperature - 45.0) / 30.0
        shapes = np.stack([1.5 * z**2 - 0.5, 2.5 * z**3 - 1.5 * z], axis=1)
        level = np.array([CURRENTS.index(i) for i in tests.current.tolist()])

        def factor(common: np.ndarray, own: np.ndarray) -> np.ndarray:
            return (1.0 + size * np.sum(shapes * (common + own[level]), axis=1))[:, None]

        post = element.post * factor(self.common[0], self.own[0])
        wrong = element._replace(
            post=post,
            yielding=element.yielding * factor(self.common[1], self.own[1]),
            stiffness=element.stiffness * factor(self.common[2], np.zeros((len(CURRENTS), 2))),
        )
        share = np.asarray(motion.velocity) / 0.5
        bend = size * self.velocity * (2.5 * share**3 - 1.5 * share) * 0.5
        force = np.asarray(element_force(wrong, motion)) + np.asarray(post) * bend
        return sine_loops(names(tests), motion, force, tests, noise_floor=0.0)


def departure(seed: int) -> Departure:
    """Random laws of a campaign."""
    rng = np.random.default_rng([seed, 1])
    return Departure(
        rng.standard_normal((3, 2)), 0.5 * rng.standard_normal((2, 6, 2)), rng.standard_normal()
    )


def main() -> None:
    parser = study_parser(__doc__ or "", "one campaign of each misfit")
    parser.add_argument("--campaigns", type=int, default=CAMPAIGNS, help="of each misfit")
    given = parser.parse_args()
    file = FOLDER / "lumped_coverage.quick.jsonl" if given.quick else WORK
    seeds = range(FIRST_SEED, FIRST_SEED + (1 if given.quick else given.campaigns))
    names = [f"{misfit:g}:{seed}" for seed in seeds for misfit in MISFITS]
    if not given.page:
        run_study(names, work, file, PROGRAM, processes=given.processes, words=words)
    rows = [row for row in read_rows(file) if row["id"] in set(names)]
    if not rows:
        sys.exit(f"No campaign is finished in {file}: run this without --page")
    make_page(rows).finish(keep=not given.quick)


def work(name: str) -> dict[str, Any]:
    """One campaign by its name: what its intervals say of the truth."""
    misfit, seed = name.split(":")
    found, truth, size, took = intervals(int(seed), float(misfit))
    return {"id": name, "misfit": float(misfit), **told(found, truth),
            **shortened({"size": size, "took": took}, 3), "program": PROGRAM}  # fmt: skip


def size_of(laws: Departure, percent: float, tests: "Conditions") -> float:
    """Size of the laws' errors at which the refitted model leaves so much."""
    from sysid.identification.fit import fit_loops
    from sysid.models.simulate import simulate
    from sysid.motion.motion import loop_motion

    if percent == 0.0:
        return 0.0
    size = START
    for _ in range(_ROUNDS):
        loops = laws.loops(tests, size)
        fit = fit_loops(loops, model="lumped", max_waves=1)
        left = loops.force - np.asarray(simulate(fit.valve, loop_motion(loops)))
        leaves = 100.0 * float(np.sqrt(np.mean(left**2) / np.mean(loops.force**2)))
        if abs(np.log(leaves / percent)) < CLOSE:
            return size
        size *= percent / leaves
    sys.exit(f"no size of the laws' errors leaves {percent:g} %")


def intervals(
    seed: int, percent: float
) -> tuple[dict[str, dict[str, Interval]], dict[str, float], float, float]:
    """All intervals of one campaign's free parameters, the truth, the laws' error and the time."""
    from lumped_campaign import CURRENTS, noisy_loops, sweep

    from sysid.identification.fit import fit_loops
    from sysid.models.lumped import TABLE_1
    from sysid.uncertainty.covariance import independent, sandwich
    from sysid.uncertainty.error_model import errors_at
    from sysid.uncertainty.propagated import by_eq_11, by_gls
    from sysid.uncertainty.sample import observed_of

    tests, laws = sweep(CURRENTS, TEMPERATURES), departure(seed)
    size = size_of(laws, percent, tests)
    loops, _ = noisy_loops(
        tests, np.random.default_rng([seed, 2]), noise=NOISE, offset=OFFSET, gain=GAIN, delay=DELAY,
        temperature=THERMOMETER, made=lambda felt: laws.loops(felt, size),
    )  # fmt: skip
    fit = fit_loops(loops, model="lumped", max_waves=1)
    begin = time.perf_counter()
    errors = errors_at(fit, observed_of(fit, loops))
    found = {
        "eq_11": by_eq_11(fit, loops, errors),
        "eq_11_straight": by_eq_11(fit, loops, errors, bent=False),
        "gls": by_gls(fit, errors),
        "tests": sandwich(fit, "tests"),
        "independent": independent(fit),
    }
    free = fit.coordinates.free
    ends: dict[str, dict[str, Interval]] = {
        kind: {p.symbol: (p.low, p.high, p.identified) for p in e.parameters if p.symbol in free}
        for kind, e in found.items()
    }
    return ends, {s: TABLE_1[s] for s in free}, size, time.perf_counter() - begin


def words(ended: Ended) -> str:
    """How the card's intervals did, in a few words."""
    signs = (ended.row or {})["holds"][CARD]
    return f"{signs.count(HOLDS)} of {len(signs) - signs.count(OPEN)} intervals hold the truth"


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """Shares of every kind of interval, and of every parameter."""
    outcome = Outcome("lumped_coverage", "Coverage of the lumped model's 95 % intervals")
    outcome.say(
        f"BS09's sweep: {2 * 6 * len(TEMPERATURES)} loops, two excitations, six currents,",
        f"{len(TEMPERATURES)} temperatures, with errors of the rig (gain {GAIN:.1%}, offset",
        f"{OFFSET:g} N, delay {1e3 * DELAY:g} ms, thermometer {THERMOMETER:g} K, noise",
        f"{NOISE:.0%} a cycle).  Truth: the lines of Table 1, also where the damper's laws bend",
        "away from them over temperature and velocity.  Only what a kind of interval calls",
        "identified counts.",
    )
    for misfit in MISFITS:
        here = [r for r in rows if r["misfit"] == misfit]
        if not here:
            continue
        table, numbers = [], {}
        for kind, name in KINDS.items():
            one = Told(here, kind)
            share, low, high = one.pooled()
            outside = one.outside()
            shown = ", ".join(f"{s} {h}/{n}" for s, (h, n) in sorted(outside.items())) or "none"
            count = sum(n for _, n in one.campaigns)
            table.append((name, f"{share:.1%} ({low:.1%} to {high:.1%})", count,
                          f"± {one.half:.2%}", shown))  # fmt: skip
            numbers[kind] = {"share": share, "low": low, "high": high, "intervals": count,
                             "half": one.half, "outside": outside}  # fmt: skip
        sizes = [r["size"] for r in here]
        laws = f", laws wrong by about {np.mean(sizes):.1%}" if misfit else ", laws right"
        outcome.say(f"## The refitted model leaves {misfit:g} %{laws}: {len(here)} campaigns")
        outcome.table(
            ("interval", "holds the truth (aim 92–98 %)", "intervals", "half width",
             f"parameters outside the {BAND:.1%} binomial band of 95 %"), table,
        )  # fmt: skip
        outcome.numbers[f"misfit_{misfit:g}"] = {"campaigns": len(here), **numbers}
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors.",
    )
    outcome.numbers["took_s"] = float(np.median([r["took"] for r in rows]))
    return outcome


if __name__ == "__main__":
    main()
