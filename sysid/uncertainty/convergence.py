r"""Have the ensembles converged: autocorrelation time, split-R̂, bulk and tail ESS.

    R̂       rank-normalised and split, between ensembles, the larger of bulk and folded; < 1.01
    ESS     bulk and tail, from all walkers of all ensembles; > 400
    τ       integrated autocorrelation time of each ensemble; it must be 50 τ long

Walkers of an ensemble are not quite independent chains, which is why R̂ is taken between ensembles
(each one chain of all its walkers, in the order of time) and ESS is not the only measure.

Source:
    Vehtari, Gelman, Simpson, Carpenter and Bürkner, Bayesian Analysis 16 (2021), as `arviz-stats`
    has it; Goodman and Weare, CAMCoS 5 (2010), and Sokal's window, as emcee has it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from arviz_stats.base.array import array_stats
from emcee.autocorr import integrated_time
from jaxtyping import Float

LARGEST_RHAT: Final = 1.01
LEAST_ESS: Final = 400.0
LENGTHS: Final = 50.0
"""Autocorrelation times that each ensemble must be long."""
TAILS: Final = (0.05, 0.95)
ENOUGH: Final = 50_000
"""Draws that R̂ is computed from; of more, every second, third, … step is taken."""
FEWEST: Final = 8
"""Steps below which nothing can be said."""


@dataclass(frozen=True)
class Convergence:
    """Evidence that draws are those of the posterior, for each of n quantities.

    Attributes:
        steps: Of each ensemble.
        tau: [n] autocorrelation time, steps; the longest of the ensembles.
        rhat: [n].
        bulk: [n] effective sample size of the middle of the distribution.
        tail: [n] of its 5 % and 95 % quantiles, the smaller one.
        names: [n].
    """

    steps: int
    tau: Float[np.ndarray, " n"]
    rhat: Float[np.ndarray, " n"]
    bulk: Float[np.ndarray, " n"]
    tail: Float[np.ndarray, " n"]
    names: tuple[str, ...]

    @property
    def reached(self) -> bool:
        """The whole rule holds for every quantity."""
        return not self.missing

    @property
    def missing(self) -> tuple[str, ...]:
        """What the rule still asks for, a sentence each."""
        if self.steps < FEWEST:
            return (f"{self.steps} steps are too few to say anything",)
        rules = (
            (self.rhat, ~(self.rhat < LARGEST_RHAT), np.max,
             f"differ between ensembles (R̂ up to {{:.3f}}, must be < {LARGEST_RHAT:g})"),
            (self.bulk, ~(self.bulk > LEAST_ESS), np.min,
             f"have too few effective draws ({{:.0f}}, must be > {LEAST_ESS:g})"),
            (self.tail, ~(self.tail > LEAST_ESS), np.min,
             f"have too few effective draws in the tails ({{:.0f}}, must be > {LEAST_ESS:g})"),
            (self.tau, ~(self.steps > LENGTHS * self.tau), np.max,
             f"need a longer chain (autocorrelation times of up to {{:.0f}} steps: {LENGTHS:g} of "
             f"them are needed, and there are {self.steps} steps)"),
        )  # fmt: skip
        told = [
            f"{_listed(self.names, bad)} {words.format(float(worst(values[bad])))}"
            for values, bad, worst, words in rules
            if bad.any()
        ]
        return tuple(told)


def convergence(
    draws: Float[np.ndarray, "ensemble step walker n"], names: Sequence[str]
) -> Convergence:
    """Measure convergence.

    Args:
        draws: Of every ensemble, in the order of time.
        names: [n] of the quantities.
    """
    ensembles, steps, walkers, n = draws.shape
    none = np.full(n, np.nan)
    if steps < FEWEST:
        return Convergence(steps, none, none, none, none, tuple(names))
    sparse = max(1, ensembles * steps * walkers // ENOUGH)
    tau, rhat, bulk, tail = np.empty((4, n))
    for k in range(n):
        one = draws[:, :, :, k]
        tau[k] = max(_time(chain) for chain in one)
        some = one[:, ::sparse].reshape(ensembles, -1)
        rhat[k] = array_stats.rhat(some, chain_axis=0, draw_axis=1, method="rank")
        chains = np.moveaxis(one, 2, 1).reshape(ensembles * walkers, steps)
        bulk[k] = array_stats.ess(chains, chain_axis=0, draw_axis=1, method="bulk")
        tail[k] = array_stats.ess(chains, chain_axis=0, draw_axis=1, method="tail", prob=TAILS)
    return Convergence(steps, tau, rhat, bulk, tail, tuple(names))


def _time(chain: Float[np.ndarray, "step walker"]) -> float:
    """Autocorrelation time; infinite where a walker has not moved at all."""
    if (np.ptp(chain, axis=0) == 0.0).any():
        return np.inf
    return float(integrated_time(chain, quiet=True, tol=0)[0])


def _listed(names: Sequence[str], bad: np.ndarray, most: int = 4) -> str:
    chosen = [name for name, one in zip(names, bad, strict=True) if one]
    more = f" and {len(chosen) - most} more" if len(chosen) > most else ""
    return ", ".join(chosen[:most]) + more
