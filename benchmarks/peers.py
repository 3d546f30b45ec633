"""Time to the global optimum against what a user would use instead, all in one run."""

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, cast

import equinox as eqx
import jax.numpy as jnp
import lmfit  # pyright: ignore[reportMissingImports] of the extra `bench`
import numpy as np
from best_known import NEAR, best_cost
from campaigns import Campaign, draw_campaign
from outcome import Outcome, arguments
from paper_symbols import LOW, SYMBOLS, TYPICAL, PaperFit, Reached, jacobian
from scipy.optimize import least_squares, minimize

from sysid.identification.fit import fit_loops
from sysid.identification.levenberg_marquardt import Descent, descend
from sysid.identification.multistart import BLOCK, in_blocks
from sysid.identification.problem import Problem, loop_problem
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build
from sysid.trials.proportions import Share, bootstrap

SURE: Final = 0.99
STARTS: Final = 2
"""Starts of every peer in a campaign, of each scatter."""
SCATTERS: Final = {
    "normal": "normal about the truth, standard deviation 50 %",
    "even": "even within ±50 % of the truth",
}
ITERATIONS: Final = 60
"""Of MINPACK; its runs that succeed take about 20, so more would only cost the peers."""
SLOW_EVERY: Final = 2
"""Slow peers run on every second campaign, from one start."""
INSIDE: Final = 1e-6
"""How far inside its bounds a start is moved, in units of the parameter's typical magnitude."""

Derivative = Callable[[np.ndarray], np.ndarray]
_POSITIVE: Final = np.isfinite(LOW)


def lm_differences(paper: PaperFit, start: np.ndarray, _: Derivative) -> None:
    """SciPy least_squares, MINPACK, finite differences, scaled by the Jacobian's columns."""
    least_squares(
        paper.residuals, start, method="lm", x_scale="jac", ftol=1e-6, xtol=1e-8,
        max_nfev=ITERATIONS * (start.size + 1),
    )  # fmt: skip


def lm_jacobian(paper: PaperFit, start: np.ndarray, derivative: Derivative) -> None:
    """The same with our Jacobian."""
    least_squares(
        paper.residuals, start, jac=cast(Any, derivative), method="lm", x_scale="jac",
        ftol=1e-6, xtol=1e-8, max_nfev=ITERATIONS,
    )  # fmt: skip


def trf_differences(paper: PaperFit, start: np.ndarray, _: Derivative) -> None:
    """SciPy least_squares, its default reflective trust region within the model's bounds."""
    least_squares(
        paper.residuals, np.maximum(start, LOW + INSIDE * TYPICAL), method="trf",
        bounds=(LOW, np.inf), x_scale=TYPICAL, ftol=1e-6, xtol=1e-8, max_nfev=200,
    )  # fmt: skip


def lmfit_leastsq(paper: PaperFit, start: np.ndarray, _: Derivative) -> None:
    """Lmfit's default: MINPACK under a transform that keeps the bounds."""
    parameters = lmfit.Parameters()
    for symbol, value, low, unit in zip(SYMBOLS, start, LOW, TYPICAL, strict=True):
        parameters.add(symbol, value=max(value, low + INSIDE * unit), min=low)

    def residuals(given: lmfit.Parameters) -> np.ndarray:
        return paper.residuals(np.array([given[symbol].value for symbol in SYMBOLS]))

    lmfit.minimize(
        residuals, parameters, method="leastsq", ftol=1e-6, xtol=1e-8, calc_covar=False,
        max_nfev=ITERATIONS * (start.size + 1),
    )  # fmt: skip


def bfgs_differences(paper: PaperFit, start: np.ndarray, _: Derivative) -> None:
    """SciPy BFGS, finite differences (as fminunc), positive parameters as logarithms."""

    def theta(z: np.ndarray) -> np.ndarray:
        return TYPICAL * np.where(_POSITIVE, np.exp(np.where(_POSITIVE, z, 0.0)), z)

    relative = np.where(_POSITIVE, np.maximum(start / TYPICAL, 1e-4), start / TYPICAL)
    z = np.where(_POSITIVE, np.log(np.where(_POSITIVE, relative, 1.0)), relative)
    minimize(
        lambda z: paper.cost(theta(z)), z, method="BFGS", options={"gtol": 1e-7, "maxiter": 1000}
    )


PEERS: Final = (
    ("least_squares lm, finite differences", lm_differences, False),
    ("least_squares trf with bounds, finite differences", trf_differences, False),
    ("least_squares lm, our Jacobian", lm_jacobian, False),
    ("lmfit leastsq with bounds, finite differences", lmfit_leastsq, False),
    ("BFGS, finite differences", bfgs_differences, True),
)
"""(name, one run from one start, slow)."""


@dataclass(frozen=True)
class Runs:
    """Runs of one method, a row a campaign.

    Attributes:
        reached: [campaign, start] it reached the best cost known.
        seconds: [campaign, start] until it did, or until it stopped.
    """

    reached: np.ndarray
    seconds: np.ndarray

    def share(self) -> Share:
        """Share of runs that reached the optimum."""
        return Share(int(self.reached.sum()), self.reached.size)

    def time_sure(self, index: np.ndarray | slice = slice(None)) -> float:
        """Mean time until an optimum is reached with 99 %: t̄ log(1 − 0.99)/log(1 − p), ≥ t̄."""
        t, p = self.seconds[index].mean(), self.reached[index].mean()
        if p <= 0.0:
            return float("inf")
        return float(t * max(np.log1p(-SURE) / np.log1p(-min(p, SURE)), 1.0))

    def time_first(self, index: np.ndarray | slice = slice(None)) -> float:
        """Mean time until the first success, t̄/p."""
        p = self.reached[index].mean()
        return float(self.seconds[index].mean() / p) if p > 0.0 else float("inf")


def run_peer(
    method: Callable[[PaperFit, np.ndarray, Derivative], None],
    paper: PaperFit,
    start: np.ndarray,
    derivative: Derivative,
) -> tuple[bool, float]:
    """One run: whether it reached the target, and its wall time."""
    begin = time.perf_counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # overflow and lost precision on the way to a bad minimum
        try:
            method(paper, start, derivative)
            reached = False
        except Reached:
            reached = True
        except (ValueError, FloatingPointError):  # the optimiser gave up on numbers not finite
            reached = False
    return reached, time.perf_counter() - begin


def run_ours(campaign: Campaign, repeats: int = 3) -> tuple[float, float]:
    """Cost, N², and median wall time of a whole fit without start."""
    fits, seconds = [], []
    for _ in range(repeats):
        begin = time.perf_counter()
        fits.append(fit_loops(campaign.loops))
        seconds.append(time.perf_counter() - begin)
    return fits[0].cost, float(np.median(seconds))


def run_one_descent(campaign: Campaign, start: np.ndarray) -> float:
    """Wall time of one descent of ours on all data from one of the peers' starts."""
    problem = loop_problem(campaign.loops)
    coordinates = GeneralizedCoordinates(problem.reference, "asymmetric")
    valve = build(Generalized, dict(zip(SYMBOLS, np.maximum(start, LOW), strict=True)))
    begin = time.perf_counter()
    end = _descend(coordinates, (in_blocks(problem, BLOCK),), coordinates.locate(valve))
    end.cost.block_until_ready()
    return time.perf_counter() - begin


@eqx.filter_jit
def _descend(
    coordinates: AbstractCoordinates, parts: tuple[Problem, ...], start: jnp.ndarray
) -> Descent:
    return descend(coordinates, parts, start, tolerance=1e-6, max_steps=200)


@dataclass(frozen=True)
class Measured:
    """What one run of the benchmark found.

    Attributes:
        ours: Whole fits without start.
        peers: (scatter, name) → runs of a peer.
        single: [campaign, start] s, one descent of ours from the peers' even starts.
        cold: s, the first, compiling, fit.
    """

    ours: Runs
    peers: dict[tuple[str, str], Runs]
    single: np.ndarray
    cold: float


def measure(campaigns: int) -> Measured:
    """Run everything, interleaved campaign by campaign."""
    begin = time.perf_counter()
    first = draw_campaign(10_000)
    fit_loops(first.loops)
    cold = time.perf_counter() - begin
    run_one_descent(first, PaperFit(first).truth)
    ours, single = ([], []), []
    peers = {(scatter, name): ([], []) for scatter in SCATTERS for name, _, _ in PEERS}
    for number in range(campaigns):
        campaign = draw_campaign(10_001 + number)
        cost, seconds = run_ours(campaign)
        best = best_cost(campaign, cost, seeds=(1,))
        ours[0].append([cost <= best * (1.0 + NEAR)])
        ours[1].append([seconds])
        paper, derivative = PaperFit(campaign), jacobian(campaign)
        derivative(paper.truth)  # compiles
        paper.target = best / float(np.sum(campaign.loops.force**2)) * (1.0 + NEAR)
        rng = np.random.default_rng(number)
        for scatter in SCATTERS:
            starts = [paper.start(rng, gaussian=scatter == "normal") for _ in range(STARTS)]
            if scatter == "even":
                single.append([run_one_descent(campaign, start) for start in starts])
            for name, method, slow in PEERS:
                if slow and number % SLOW_EVERY:
                    continue
                used = starts[:1] if slow else starts
                ends = [run_peer(method, paper, start, derivative) for start in used]
                peers[scatter, name][0].append([reached for reached, _ in ends])
                peers[scatter, name][1].append([seconds for _, seconds in ends])
    return Measured(
        Runs(*map(np.array, ours)),
        {key: Runs(np.array(r), np.array(t)) for key, (r, t) in peers.items()},
        np.array(single),
        cold,
    )


def row(name: str, run: Runs, ours: Runs) -> tuple[list[object], dict[str, object]]:
    """A line of the table, and the same as numbers."""
    count = run.seconds.shape[0]
    every = SLOW_EVERY if count < ours.seconds.shape[0] else 1
    sure = bootstrap(run.time_sure, count)
    ratio = bootstrap(lambda k: run.time_sure(k) / ours.time_sure(every * k), count)
    cells = [
        name, run.share(), f"{run.seconds.mean():.2f}", f"{run.time_first():.2f}",
        f"{sure[0]:.2f} ({sure[1]:.2f} to {sure[2]:.2f})",
        f"{ratio[0]:.1f} ({ratio[1]:.1f} to {ratio[2]:.1f})",
    ]  # fmt: skip
    numbers = {
        "share": run.share().as_dict(), "seconds_a_start": float(run.seconds.mean()),
        "seconds_first": run.time_first(), "seconds_99": sure, "ratio_99": ratio,
    }  # fmt: skip
    return cells, numbers


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", 20, 2)
    found = measure(campaigns)
    outcome = Outcome("peers", "Time to the global optimum")
    outcome.say(
        f"{campaigns} random campaigns (110 loops of 360 points, noise 1 %, 16 parameters).",
        f"Peers: {STARTS} starts each of either scatter (BFGS: one, on every second campaign),",
        "NumPy residuals, scaled variables, stopped once the cost is within 0.1 % of the best",
        "known.",
        "Ours: the whole warm fit_loops without any start, run to its own end.",
        "Time at 99 %: mean time a start × log 0.01 / log(1 − share).",
    )
    for scatter, words in SCATTERS.items():
        outcome.lines += ["", f"## Starts {words}"]
        runs = {"ours": found.ours}
        runs |= {name: run for (which, name), run in found.peers.items() if which == scatter}
        lines = {name: row(name, run, found.ours) for name, run in runs.items()}
        outcome.table(
            (
                "method", "reaches it from one start", "s a start", "s to first success",
                "s at 99 % (95 % interval)", "times ours (95 % interval)",
            ),
            [cells for cells, _ in lines.values()],
        )  # fmt: skip
        outcome.numbers[scatter] = {name: numbers for name, (_, numbers) in lines.items()}
    outcome.lines += ["", "## Beside it"]
    outcome.say(
        "Targets: least_squares with finite differences ≥ 20 times ours, BFGS with finite",
        "differences ≥ 100 times.",
    )
    one, single = found.peers["even", PEERS[0][0]].seconds.mean(axis=1), found.single.mean(axis=1)
    ratio = bootstrap(lambda k: float(one[k].mean() / single[k].mean()), campaigns)
    outcome.say(
        "One Levenberg–Marquardt run on all data from the same even start: ours",
        f"{single.mean():.2f} s to its own end; SciPy's lm with finite differences takes",
        f"{ratio[0]:.1f} times as long ({ratio[1]:.1f} to {ratio[2]:.1f}), though it is",
        "stopped at the target (expected 3 to 5).",
    )
    outcome.say(f"The first fit of the process, compilation included, took {found.cold:.1f} s.")
    outcome.numbers |= {"one_run_ratio": ratio, "cold_seconds": found.cold}
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
