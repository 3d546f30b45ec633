"""Size and shape of what may change the force from cycle to cycle, by likelihood."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.optimize import minimize_scalar

from sysid.diagnosis.contenders import SHAPE
from sysid.diagnosis.cycle_candidates import Candidate
from sysid.diagnosis.cycle_evidence import CycleEvidence, Cycles
from sysid.diagnosis.cycle_fit import Fitted, fit_change

WIDER: Final = 4.0
"""A shape parameter may be so many times smaller or larger than realistic values."""
GRID: Final = 9
FINE: Final = 0.02
"""Step of ln(shape) at which refining ends."""
STEP: Final = 0.05
"""Of the logarithms of size and shape, for derivatives."""
STEPS: Final = 3
"""Gauss–Newton steps of the size: forces fall a little less than in proportion to it."""


@dataclass(frozen=True)
class Raced:
    """A candidate that was fitted.

    Attributes:
        candidate: The candidate.
        shape: Its shape parameter.
        change: [T, C, m] N, of the size that was found.
        slope: [T, C, m] N per unit of size, there.
        fitted: With its size.
        gain: Log-likelihood gained, less `SHAPE` for the shape parameter.
    """

    candidate: Candidate
    shape: float
    change: Cycles
    slope: Cycles
    fitted: Fitted
    gain: float


def race(cycles: CycleEvidence, null: Fitted, candidate: Candidate) -> Raced:
    """Fit size and shape of a candidate."""
    ends = np.log(candidate.shapes[0] / WIDER), np.log(candidate.shapes[-1] * WIDER)
    grid = np.linspace(*ends, GRID)
    size, likely = candidate.nominal, []
    for z in grid:
        likely.append(_step(cycles, null, candidate, float(np.exp(z)), size)[0].likelihood)
    first = int(np.argmax(likely))
    for _ in range(STEPS):
        size = _step(cycles, null, candidate, float(np.exp(grid[first])), size)[0].size or size
    around = grid[max(first - 1, 0)], grid[min(first + 1, GRID - 1)]

    def cost(z: float) -> float:
        return -_step(cycles, null, candidate, float(np.exp(z)), size)[0].likelihood

    found = minimize_scalar(cost, bounds=around, method="bounded", options={"xatol": FINE})
    shape = float(np.exp(getattr(found, "x")))  # noqa: B009 - the result's type has no stub
    for _ in range(STEPS):
        size = _step(cycles, null, candidate, shape, size)[0].size or size
    fitted, slope = _step(cycles, null, candidate, shape, size)
    gain = fitted.likelihood - null.likelihood - SHAPE
    return Raced(candidate, shape, candidate.change(shape, fitted.size), slope, fitted, gain)


def _step(
    cycles: CycleEvidence, null: Fitted, candidate: Candidate, shape: float, size: float
) -> tuple[Fitted, Cycles]:
    """A Gauss–Newton step of the size from a given one, and the slope there."""
    up, here, down = (candidate.change(shape, size * z) for z in (1.0 + STEP, 1.0, 1.0 - STEP))
    slope = (up - down) / (2.0 * STEP * size)
    beyond = replace(cycles, change=cycles.change - here + size * slope)
    return fit_change(beyond, slope, signed=candidate.signed, start=null.scatter), slope
