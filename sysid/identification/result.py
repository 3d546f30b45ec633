"""What a fit returns: values, and the evidence for them."""

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sysid.identification.problem import Problem, Weights
from sysid.models.base import AbstractValve
from sysid.models.coordinates import AbstractCoordinates

if TYPE_CHECKING:
    import pandas as pd


class Result(enum.Enum):
    """How a fit ended; the value is the sentence for people."""

    converged = "The best minimum was reached from several independent starts."
    rare = (
        "The best minimum was reached from one or two starts only: a better one may exist. "
        "Do not trust this fit before it has been repeated with another --seed."
    )
    unfinished = (
        "The last descent was still lowering the cost when it ran out of steps: the parameters "
        "are not those of a minimum."
    )


@dataclass(frozen=True)
class Basin:
    """A local minimum that starts ended in.

    Attributes:
        cost: Cost relative to the best basin's (1 for the best).
        hits: How many starts ended in it.
    """

    cost: float
    hits: int


@dataclass(frozen=True)
class TestError:
    """Free-run error of one test.

    Attributes:
        id: Record id.
        rmse: N, over the steady loop (or the whole record where it is not sinusoidal).
        nrmse: rmse / max|F|.
        fit_percent: 100 (1 − rmse / std F).
        noise_floor: N; NaN where it cannot be known.
        held_out: Not used for the fit, kept to measure its error.
        used: Used for the fit.
        why_not: Why it was neither used nor held out; errors are NaN then.
    """

    __test__ = False  # not a pytest class

    id: str
    rmse: float
    nrmse: float
    fit_percent: float
    noise_floor: float
    held_out: bool
    used: bool
    why_not: str | None = None


@dataclass(frozen=True)
class Fit:
    """An identified valve model.

    Attributes:
        model: Name in the registry of models, e.g. "generalized".
        variant: Which of its parameters were free.
        weights: How tests were weighted.
        valve: The model with its identified parameters.
        coordinates: The map from solver coordinates to the model.
        u: [n] solver coordinates of `valve`.
        problems: What was fitted (used tests only): loops, then records on time grids.
        condition: [L] number of the (amplitude, frequency) condition of each used loop.
        cost: Σ w² (F − F̂)², in N² for weights "paper".
        result: How it ended.
        starts: How many starts were made.
        basins: Minima seen, best first.
        tests: One entry a test of the campaign.
        notes: Sentences about what was held or assumed, and why.
    """

    model: str
    variant: str
    weights: Weights
    valve: AbstractValve
    coordinates: AbstractCoordinates
    u: np.ndarray
    problems: tuple[Problem, ...]
    condition: np.ndarray
    cost: float
    result: Result
    starts: int
    basins: tuple[Basin, ...]
    tests: tuple[TestError, ...]
    notes: tuple[str, ...] = ()

    @property
    def mean_nrmse(self) -> float:
        """Mean of RMSE/max|F| over the tests that were fitted."""
        return _mean([t.nrmse for t in self.tests if t.used])

    @property
    def held_out_mean_nrmse(self) -> float | None:
        """Mean of RMSE/max|F| over the held-out tests, None without any."""
        errors = [t.nrmse for t in self.tests if t.held_out]
        return _mean(errors) if errors else None

    def to_frame(self) -> "pd.DataFrame":
        """One row a test."""
        import pandas as pd

        return pd.DataFrame(
            [
                {
                    "id": t.id, "rmse_N": t.rmse, "nrmse": t.nrmse, "fit_percent": t.fit_percent,
                    "noise_floor_N": t.noise_floor, "held_out": t.held_out, "used": t.used,
                    "why_not": t.why_not,
                }
                for t in self.tests
            ]
        )  # fmt: skip


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else float("nan")
