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
from sysid.likelihood.reml import Restricted, fit_sizes
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
class _Tried(Generic[Measured]):
    """Correlation lengths, and how probable the residual is with them."""

    steps: Steps
    restricted: Restricted
    observed: Measured

    @property
    def value(self) -> float:
        """Restricted log-likelihood."""
        return self.restricted.log_likelihood


def smoothness_and_sizes(
    observed: Measured,
    coordinates: AbstractCoordinates,
    u: Float[np.ndarray, " n"],
    near: Sizes | None = None,
) -> tuple[Measured, Restricted]:
    """The same, with errors of the laws as smooth over conditions as is most probable.

    From the shortest correlation lengths steps are taken for as long as they make the residual more
    probable: along temperature, where the valve has laws of it, then in all others and, where that
    helps, in each of them.

    Args:
        observed: Measured loops beside a model (`Observed.beside`).
        coordinates: Map from u to the model.
        u: [n], fitted.
        near: Sizes with the shortest lengths, where they are about known.

    Returns:
        The loops, and the sizes of Σ at u, to a third of `TOLERANCE`.
    """
    residual, jacobian = observed.look(coordinates, u)
    least = shortest(thermal=bool(np.isfinite(observed.parts.lengths[-1])))

    def at(steps: Steps, start: Sizes | None) -> _Tried[Measured]:
        a, f, i, t = (length * STEP**n for length, n in zip(least, steps, strict=True))
        kernel = kernel_of(observed.loops, (a, f, i, t))
        parts = replace(observed.parts, kernel=kernel, lengths=(a, f, i, t))
        here = replace(observed, parts=parts)
        found = fit_sizes(here.parts, residual, jacobian, start, tolerance=TOLERANCE / 3.0)
        return _Tried(steps, found, here)

    def climbed(start: _Tried[Measured], way: Steps) -> _Tried[Measured]:
        best = start
        while True:
            steps = tuple(s + w for s, w in zip(best.steps, way, strict=True))
            if not 0 <= min(steps) <= max(steps) <= MOST:
                return best
            there = at(steps, best.restricted.sizes)
            if there.value <= best.value + TOLERANCE:
                return best
            best = there

    first = at((0, 0, 0, 0), near)
    warm = climbed(first, (0, 0, 0, 1)) if np.isfinite(least[3]) else first
    best = climbed(warm, (1, 1, 1, 0))
    if best is warm:
        return (observed if warm is first else warm.observed), warm.restricted
    for along in np.eye(3, 4, dtype=int).tolist():
        further = climbed(best, tuple(along))
        best = further if further is not best else climbed(best, tuple(-w for w in along))
    return best.observed, best.restricted
