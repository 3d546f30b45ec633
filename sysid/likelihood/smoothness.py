"""How smooth the errors of a valve's laws are over conditions, by REML like their sizes.

Errors that are smoother than Σ takes them to be are larger than it finds them: most of what they
do is taken up by parameters, and only what is left is seen.  Parameters then get intervals that are
too narrow.
"""

from dataclasses import dataclass, replace
from typing import Final, Generic, TypeVar

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Sizes
from sysid.likelihood.kernel import kernel_of, shortest
from sysid.likelihood.observed import Observed
from sysid.likelihood.reml import TIMES, Restricted, fit_sizes
from sysid.models.coordinates import AbstractCoordinates

STEP: Final = 2.0**0.5
"""Ratio of neighbouring correlation lengths that are tried."""
MOST: Final = 4
"""Steps from the shortest lengths at most: errors with still longer ones are trends over all."""
TOLERANCE: Final = 0.3
"""Log-likelihood that a step must gain."""

Measured = TypeVar("Measured", bound=Observed)
Steps = tuple[int, ...]


@dataclass(frozen=True)
class Tried(Generic[Measured]):
    """Correlation lengths, and how probable the residual is with them.

    Attributes:
        steps: From the shortest lengths.
        restricted: Sizes of Σ.
        observed: The loops with such a K_c.
    """

    steps: Steps
    restricted: Restricted
    observed: Measured

    @property
    def value(self) -> float:
        """Restricted log-likelihood."""
        return self.restricted.log_likelihood


@dataclass(frozen=True)
class Residual(Generic[Measured]):
    """What a model leaves, for Σ of any correlation lengths.

    Attributes:
        observed: Measured loops beside the model.
        residual: [L, m] N.
        jacobian: [L, m, n] of the model's free parameters.
        times: Largest error of the laws, in parts of `Parts.error`, as `fit_sizes` has it.
    """

    observed: Measured
    residual: Float[np.ndarray, "loop m"]
    jacobian: Float[np.ndarray, "loop m n"]
    times: float = TIMES

    @property
    def thermal(self) -> bool:
        """K_c goes by temperature."""
        return bool(np.isfinite(self.observed.parts.lengths[-1]))

    def at(self, steps: Steps, near: Sizes | None) -> Tried[Measured]:
        """With lengths so many steps from the shortest, √2 each.

        Args:
            steps: In ln A, ln f, current and temperature.
            near: Sizes, where they are about known.
        """
        least = shortest(thermal=self.thermal)
        a, f, i, t = (length * STEP**n for length, n in zip(least, steps, strict=True))
        kernel = kernel_of(self.observed.loops, (a, f, i, t))
        parts = replace(self.observed.parts, kernel=kernel, lengths=(a, f, i, t))
        found = fit_sizes(
            parts, self.residual, self.jacobian, near, tolerance=TOLERANCE / 3.0, times=self.times
        )
        return Tried(steps, found, replace(self.observed, parts=parts))


def smoothness_and_sizes(
    observed: Measured,
    coordinates: AbstractCoordinates,
    u: Float[np.ndarray, " n"],
    near: Sizes | None = None,
    *,
    times: float = TIMES,
) -> tuple[Measured, Restricted]:
    """The same, with errors of the laws as smooth over conditions as is most probable.

    From the shortest correlation lengths, whatever those of the loops are, steps are taken for as
    long as they make the residual more probable: along temperature, where the valve has laws of it,
    then in all others and, where that helps, in each of them.

    Args:
        observed: Measured loops beside a model (`Observed.beside`), of any correlation lengths.
        coordinates: Map from u to the model.
        u: [n], fitted.
        near: Sizes with the shortest lengths, where they are about known.
        times: Largest error of the laws, in parts of `Parts.error`, as `fit_sizes` has it.

    Returns:
        The loops, with the lengths found, and the sizes of Σ at u, to a third of `TOLERANCE`.
    """
    left = Residual(observed, *observed.look(coordinates, u), times)

    def climbed(start: Tried[Measured], way: Steps) -> Tried[Measured]:
        best = start
        while True:
            steps = tuple(s + w for s, w in zip(best.steps, way, strict=True))
            if not 0 <= min(steps) <= max(steps) <= MOST:
                return best
            there = left.at(steps, best.restricted.sizes)
            if there.value <= best.value + TOLERANCE:
                return best
            best = there

    first = left.at((0, 0, 0, 0), near)
    warm = climbed(first, (0, 0, 0, 1)) if left.thermal else first
    best = climbed(warm, (1, 1, 1, 0))
    if best is warm:
        return warm.observed, warm.restricted
    for along in np.eye(3, 4, dtype=int).tolist():
        further = climbed(best, tuple(along))
        best = further if further is not best else climbed(best, tuple(-w for w in along))
    return best.observed, best.restricted
