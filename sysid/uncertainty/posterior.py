"""Draws from the posterior, and what they say of each parameter."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from jaxtyping import Float

from sysid.parameters import ParamSpec
from sysid.uncertainty.compression import CompressionError
from sysid.uncertainty.convergence import Convergence
from sysid.uncertainty.covariance import LEVEL, OPEN, magnitude_of
from sysid.uncertainty.error_model import Likelihood
from sysid.uncertainty.estimate import Estimate

if TYPE_CHECKING:
    import pandas as pd

AT_BOUND: Final = 0.05
"""The density does not fall towards a bound if the first hundredth of the draws is nearer to it
than this, in distances from there to the median: 0.02 for half a normal density, 0.16 for one that
rises from zero in a straight line."""


@dataclass(frozen=True)
class Posterior:
    """A sampled posterior.

    Chains are ensembles; the draws of an ensemble are its walkers, step after step.

    Attributes:
        model: Name of the model.
        variant: Its variant.
        likelihood: Kind of the likelihood.
        assumed: What the likelihood assumes, a sentence.
        prior: One line a parameter.
        declared: Of the free parameters.
        coordinates: [chain, draw, n] solver coordinates.
        draws: [chain, draw, n] free parameters, in their units.
        log_probability: [chain, draw], up to a constant.
        walkers: Of an ensemble.
        convergence: Evidence.
        compression: What compressing the likelihood changed.
        acceptance: Share of accepted moves.
        evaluations: Of the log-probability, warm-up included.
        message: How sampling ended, a sentence.
        open: Symbols of parameters whose profile stays low on a side, without end or down to a
            bound that their interval does not begin at; where it ends there is the prior's doing.
    """

    model: str
    variant: str
    likelihood: Likelihood
    assumed: str
    prior: tuple[str, ...]
    declared: tuple[ParamSpec, ...]
    coordinates: Float[np.ndarray, "chain draw n"]
    draws: Float[np.ndarray, "chain draw n"]
    log_probability: Float[np.ndarray, "chain draw"]
    walkers: int
    convergence: Convergence
    compression: CompressionError
    acceptance: float
    evaluations: int
    message: str
    open: tuple[str, ...] = ()

    @property
    def symbols(self) -> tuple[str, ...]:
        """Of the free parameters."""
        return tuple(spec.symbol for spec in self.declared)

    @property
    def trusted(self) -> bool:
        """It has converged, and compression changed nothing that matters."""
        return self.convergence.reached and self.compression.small

    @property
    def account(self) -> str:
        """How sampling ended, and all that speaks against the draws."""
        missing = "; ".join(self.convergence.missing)
        told = self.message + (f" ({missing})" if missing else "")
        return told if self.compression.small else f"{told}; {self.compression.words}"

    @property
    def flat(self) -> Float[np.ndarray, "draw n"]:
        """[draw, n] of all chains."""
        return self.draws.reshape(-1, self.draws.shape[2])

    @property
    def by_walker(self) -> Float[np.ndarray, "chain step walker n"]:
        """[chain, step, walker, n]."""
        chains, _, n = self.draws.shape
        return self.draws.reshape(chains, -1, self.walkers, n)

    @property
    def covariance(self) -> Float[np.ndarray, "n n"]:
        """Of the free parameters, in their units."""
        return np.atleast_2d(np.cov(self.flat, rowvar=False))

    @property
    def interval_words(self) -> str:
        """What the intervals are."""
        return f"{LEVEL:g}, posterior, {self.likelihood.replace('_', ' ')} likelihood"

    @property
    def parameters(self) -> tuple[Estimate, ...]:
        """Median, standard deviation and interval of each free parameter."""
        middle, sd = np.median(self.flat, axis=0), self.flat.std(axis=0)
        bounds = [(spec.low, spec.high) for spec in self.declared]
        near = sd <= OPEN * magnitude_of(middle, self.declared)
        ends = [interval(z, *both) for z, both in zip(self.flat.T, bounds, strict=True)]
        return tuple(
            Estimate(
                symbol=spec.symbol,
                name=spec.name,
                unit=spec.unit,
                value=float(middle[k]),
                sd=float(sd[k]),
                low=ends[k][0],
                high=ends[k][1],
                identified=bool(near[k]) and spec.symbol not in self.open,
            )
            for k, spec in enumerate(self.declared)
        )

    def to_frame(self) -> "pd.DataFrame":
        """One row a parameter, with the evidence of convergence."""
        import pandas as pd

        frame = pd.DataFrame([vars(p) for p in self.parameters]).rename(columns={"value": "median"})
        c = self.convergence
        return frame.assign(tau=c.tau, rhat=c.rhat, ess_bulk=c.bulk, ess_tail=c.tail)


def interval(draws: Float[np.ndarray, " draw"], low: float, high: float) -> tuple[float, float]:
    """Interval of `LEVEL` of the draws, with the same share left out on either side.

    Where the density does not fall towards a bound of the parameter, the interval begins there: a
    central one would leave out the bound, and with it the truth where that is zero.

    Args:
        draws: Of a parameter.
        low: Its lower bound.
        high: Its upper bound.
    """
    first, middle, last = np.quantile(draws, [0.01, 0.5, 0.99])
    if first - low < AT_BOUND * (middle - first):
        return low, float(np.quantile(draws, LEVEL))
    if high - last < AT_BOUND * (last - middle):
        return float(np.quantile(draws, 1.0 - LEVEL)), high
    return (
        float(np.quantile(draws, 0.5 - LEVEL / 2)),
        float(np.quantile(draws, 0.5 + LEVEL / 2)),
    )
