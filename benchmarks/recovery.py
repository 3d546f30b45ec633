"""How often the fit, given no start, finds the global optimum, and says so when it does not."""

import time
import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, cast

import numpy as np
from best_known import NEAR, best_cost
from campaigns import Campaign, draw_campaign
from outcome import Outcome, arguments
from paper_symbols import PaperFit, Reached, jacobian
from scipy.optimize import least_squares

from sysid.identification.fit import fit_loops
from sysid.identification.result import Result
from sysid.trials.proportions import Share


@dataclass(frozen=True)
class Trial:
    """One campaign.

    Attributes:
        seed: Of the campaign.
        table: It was drawn about.
        excess: Cost over the best known, less 1.
        result: What the fit said of itself.
        starts: It made.
        seconds: Wall time of the whole fit.
        plain: A plain start reached the optimum, ±50 % evenly about the truth.
        gaussian: Likewise, normal about the truth with standard deviation 50 %.
    """

    seed: int
    table: str
    excess: float
    result: str
    starts: int
    seconds: float
    plain: bool
    gaussian: bool

    @property
    def found(self) -> bool:
        """The fit ended within 0.1 % of the best cost known."""
        return self.excess <= NEAR

    @property
    def said(self) -> bool:
        """The fit claimed to have converged."""
        return self.result == Result.converged.name


def trial(seed: int) -> Trial:
    """Fit one campaign, and try one plain start beside it."""
    campaign = draw_campaign(seed)
    begin = time.perf_counter()
    fit = fit_loops(campaign.loops)
    seconds = time.perf_counter() - begin
    best = best_cost(campaign, fit.cost)
    return Trial(
        seed, campaign.table, fit.cost / best - 1.0, fit.result.name, fit.starts, seconds,
        *plain_starts(campaign, best, np.random.default_rng(seed)),
    )  # fmt: skip


def plain_starts(campaign: Campaign, best: float, rng: np.random.Generator) -> tuple[bool, bool]:
    """Whether MINPACK gets there from one even and from one normal start about the truth."""
    paper = PaperFit(campaign)
    paper.target = best / float(np.sum(campaign.loops.force**2)) * (1.0 + NEAR)
    derivative = jacobian(campaign)
    even, normal = paper.start(rng), paper.start(rng, gaussian=True)
    return reaches(paper, derivative, even), reaches(paper, derivative, normal)


def reaches(
    paper: PaperFit, derivative: Callable[[np.ndarray], np.ndarray], start: np.ndarray
) -> bool:
    """MINPACK's Levenberg–Marquardt in the paper's symbols, from one start to the end."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # overflow on the way to a bad minimum
        try:
            least_squares(
                paper.residuals, start, jac=cast(Any, derivative), method="lm",
                x_scale="jac", ftol=1e-8, xtol=1e-8, max_nfev=500,
            )  # fmt: skip
        except Reached:
            return True
    return False


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", 200, 10)
    trials = [trial(seed) for seed in range(campaigns)]
    found = Share(sum(t.found for t in trials), campaigns)
    plain = Share(sum(t.plain for t in trials), campaigns)
    gaussian = Share(sum(t.gaussian for t in trials), campaigns)
    missed = [t for t in trials if not t.found]
    silent = [t for t in missed if t.said]
    doubted = sum(t.found and not t.said for t in trials)
    warm = [t.seconds for t in trials[1:]] or [trials[0].seconds]
    outcome = Outcome("recovery", "Recovery of the global optimum")
    outcome.say(
        f"{campaigns} random campaigns, 110 loops of 360 points each, noise 1 %. The optimum is",
        "reached if the cost is within 0.1 % of the best known: the lowest of the fit, a descent",
        "from the truth, and fits with two other seeds.",
    )
    outcome.table(
        ("", "share (95 % interval)", "target"),
        (
            ("fit without start ends in the optimum", found, "≥ 99 %"),
            (
                "of those that did not, the result said so",
                f"{len(missed) - len(silent)} of {len(missed)}", "all",
            ),
            ("ended in the optimum, yet doubted it", f"{doubted} of {found.hits}", "–"),
            ("one plain start, even within ±50 % of the truth", plain, "about half"),
            ("one plain start, normal, standard deviation 50 %", gaussian, "about half"),
        ),
    )  # fmt: skip
    outcome.table(
        ("table", "fit", "plain start, even", "plain start, normal"),
        [
            (
                table,
                Share(sum(t.found for t in part), len(part)),
                Share(sum(t.plain for t in part), len(part)),
                Share(sum(t.gaussian for t in part), len(part)),
            )
            for table in sorted({t.table for t in trials})
            for part in [[t for t in trials if t.table == table]]
        ],
    )
    outcome.say(
        f"Warm wall time of a whole fit: median {np.median(warm):.2f} s, slowest",
        f"{max(warm):.2f} s; the first one, compilation included: {trials[0].seconds:.1f} s.",
        f"Starts a fit: median {np.median([t.starts for t in trials]):.0f}, at most",
        f"{max(t.starts for t in trials)}.",
        f"Largest excess of cost: {max(t.excess for t in trials):.1e}.",
    )
    outcome.numbers = {
        "found": found.as_dict(), "plain": plain.as_dict(), "gaussian": gaussian.as_dict(),
        "silent_failures": len(silent),
        "missed": [asdict(t) for t in missed], "doubted": doubted,
        "median_seconds": float(np.median(warm)), "first_seconds": trials[0].seconds,
    }  # fmt: skip
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
