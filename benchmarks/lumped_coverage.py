"""How often 95 % intervals of the lumped model's parameters contain the truth, laws right or wrong.

BS09's sweep with errors of the rig; laws that are wrong err smoothly over amplitude, frequency,
current and temperature.  Every finished campaign is one line of a work file, so that a study goes
on where it was.
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
from interval_campaign import BANDS
from interval_rows import MISFITS, Interval, Measured, row_of, say_shares, study
from jaxtyping import Float
from outcome import Outcome

from sysid.trials.program import fingerprint

if TYPE_CHECKING:
    from lumped_campaign import Conditions

    from sysid.data.loops import Loops

TEMPERATURES: Final = (15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0)
"""°C."""
GAIN, OFFSET, DELAY, THERMOMETER, NOISE = 6e-3, 2.0, 1e-4, 0.3, 0.01
"""Errors of the rig: of the load cell, N, s, K; noise of a cycle in parts of max|F|."""
START: Final = 0.03
"""Size of the laws' errors that is tried first."""
CLOSE: Final = 0.03
"""Relative difference to what the refitted model is to leave that is near enough."""
SMOOTH, WAVES = 0.6, 60
"""Correlation length of the laws' errors in parts of the ranges; features of a random field."""
RANGES: Final = (
    (np.log(2.5e-3), np.log(75e-3)), (np.log(0.1), np.log(15.0)), (0.0, 1.0), (15.0, 75.0),
)  # fmt: skip
"""Of ln A (m), ln f (Hz), current A and temperature °C."""
_ROUNDS: Final = 6
PROGRAM: Final = fingerprint(
    ("arrays.py", "data", "effects", "identification", "likelihood", "models", "motion",
     "parameters.py", "rig/planters/periodic.py", "uncertainty", "units.py"), BANDS,
)  # fmt: skip
"""Rows count for the program that fitted and told the intervals."""
KINDS: Final = {
    "eq_11": "values of Eq. 11 under Σ, along profiles (the card's)",
    "eq_11_straight": "the same, ± t standard errors",
    "gls": "values of GLS, ± t standard errors",
    "tests": "values of Eq. 11, sandwich over tests",
    "independent": "the same, independent points",
}


@dataclass(frozen=True)
class Departure:
    """How a damper's C_post, F_y and k depart from those of the model.

    Relative errors are random fields of unit variance and squared-exponential covariance in log A,
    log f, current and temperature, as smooth as those of the damper in the blind trials
    (`sysid.rig.trial_misfit`), which go by the first three.

    Attributes:
        waves: [3, 4, W] random Fourier features, in parts of the ranges.
        phases: [3, W] theirs.
    """

    waves: np.ndarray
    phases: np.ndarray

    def factors(self, tests: "Conditions") -> np.ndarray:
        """Relative errors of C_post, F_y and k at size 1, [3, L]."""
        angles = place_of(tests) @ self.waves + self.phases[:, None]
        return np.sqrt(2.0 / WAVES) * np.cos(angles).sum(axis=2)

    def loops(self, tests: "Conditions", size: float) -> "Loops":
        """Clean steady loops of the damper, its laws wrong by so much."""
        from lumped_campaign import names, table_1
        from sine_loops import sine_loops

        from sysid.models.lumped import element_force
        from sysid.motion.motion import sine_motion

        motion = sine_motion(*tests, points=360)
        element = table_1().element(motion)
        post, yielding, stiffness = 1.0 + size * self.factors(tests)[:, :, None]
        wrong = element._replace(
            post=element.post * post,
            yielding=element.yielding * yielding,
            stiffness=element.stiffness * stiffness,
        )
        force = np.asarray(element_force(wrong, motion))
        return sine_loops(names(tests), motion, force, tests, noise_floor=0.0)


def place_of(tests: "Conditions") -> Float[np.ndarray, "loop 4"]:
    """Conditions in parts of `RANGES`."""
    values = (np.log(tests.amplitude), np.log(tests.frequency), *tests[2:])
    columns = [(z - low) / (high - low) for z, (low, high) in zip(values, RANGES, strict=True)]
    return np.stack(columns, axis=1)


def departure(seed: int) -> Departure:
    """Random laws of a campaign."""
    rng = np.random.default_rng([seed, 1])
    waves = rng.standard_normal((3, 4, WAVES)) / SMOOTH
    return Departure(waves, rng.uniform(0.0, 2.0 * np.pi, (3, WAVES)))


def main() -> None:
    study(
        __doc__, "lumped_coverage", campaigns=100, first_seed=63_000_000, work=work,
        program=PROGRAM, page=make_page,
    )  # fmt: skip


def work(name: str) -> dict[str, Any]:
    """One campaign by its name: what its intervals say of the truth."""
    return row_of(name, intervals, PROGRAM)


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


def intervals(seed: int, percent: float) -> Measured:
    """All intervals of one campaign's free parameters, the truth, the laws' error and the time."""
    from lumped_campaign import CURRENTS, noisy_loops, sweep

    from sysid.identification.fit import fit_loops
    from sysid.models.lumped import TABLE_1
    from sysid.uncertainty.covariance import independent, sandwich
    from sysid.uncertainty.error_model import errors_at, errors_at_best
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
    observed = observed_of(fit, loops)
    errors = errors_at(fit, observed)
    found = {
        "eq_11": by_eq_11(fit, loops, errors),
        "eq_11_straight": by_eq_11(fit, loops, errors, bent=False),
        "gls": by_gls(fit, errors_at_best(fit, observed, errors)),
        "tests": sandwich(fit, "tests"),
        "independent": independent(fit),
    }
    free = fit.coordinates.free
    ends: dict[str, dict[str, Interval]] = {
        kind: {p.symbol: (p.low, p.high, p.identified) for p in e.parameters if p.symbol in free}
        for kind, e in found.items()
    }
    took = time.perf_counter() - begin
    wrong = size * float(np.sqrt(np.mean(laws.factors(tests) ** 2)))
    return Measured(ends, {s: TABLE_1[s] for s in free}, wrong, took)


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """Shares of every kind of interval, and of every parameter."""
    outcome = Outcome("lumped_coverage", "Coverage of the lumped model's 95 % intervals")
    outcome.say(
        f"BS09's sweep: {2 * 6 * len(TEMPERATURES)} loops, two excitations, six currents,",
        f"{len(TEMPERATURES)} temperatures, with errors of the rig (gain {GAIN:.1%}, offset",
        f"{OFFSET:g} N, delay {1e3 * DELAY:g} ms, thermometer {THERMOMETER:g} K, noise",
        f"{NOISE:.0%} a cycle).  Truth: the lines of Table 1, also where the damper's laws depart",
        "smoothly from them over amplitude, frequency, current and temperature.  Only what a kind",
        "of interval calls identified counts.",
    )
    for misfit in MISFITS:
        say_shares(outcome, rows, KINDS, misfit)
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors.",
    )
    outcome.numbers["took_s"] = float(np.median([r["took"] for r in rows]))
    return outcome


if __name__ == "__main__":
    main()
