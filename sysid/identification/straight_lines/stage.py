"""What one straight line through one loop says, how surely, and from which points."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from sysid.data.loops import Loops
from sysid.identification.straight_lines.windows import Window

FEWEST: Final = 3
"""Points that a line must have on each branch."""


class Found(NamedTuple):
    """A value read off both branches of one loop.

    Attributes:
        value: Mean of both branches.
        half_difference: Half of compression minus extension; NaN where the offset takes it up.
        cycles: [cycles] value of each cycle.
        offset: N, about which both branches are symmetric.
        used: [J] points that lie in one of the two windows.
    """

    value: float
    half_difference: float
    cycles: np.ndarray
    offset: float
    used: np.ndarray


Measure = Callable[[Loops, int, Window], Found | str]
"""Loops, which of them, points to use → what was found, or why nothing was."""


@dataclass(frozen=True)
class Reading:
    """One quantity of one test.

    Attributes:
        test: Place of the test among the loops.
        id: Its id.
        current: A.
        temperature: °C (NaN where unknown).
        value: In SI.
        se: Its standard error.  The residuals of a line through a loop are neighbours of one
            another and tell nothing of it; cycles do, each a repetition.  Where only one cycle is
            known, both directions of motion are the repetitions; NaN where there are none.
        replicates: How many repetitions `se` comes from.
        half_difference: Half of compression minus extension, zero for a symmetric damper; NaN
            for F_y, where it cannot be told from the offset.
        offset: N, removed so that both directions agree.
        used: [J] the points of the loop that were used.
        choices: [windows] value with other choices of points; NaN where a window holds too few.
    """

    test: int
    id: str
    current: float
    temperature: float
    value: float
    se: float
    replicates: int
    half_difference: float
    offset: float
    used: Bool[np.ndarray, " phase"]
    choices: Float[np.ndarray, " window"]

    @property
    def spread(self) -> float:
        """Standard deviation over the choices of points; NaN with fewer than two."""
        told = self.choices[np.isfinite(self.choices)]
        return float(told.std(ddof=1)) if told.size > 1 else float("nan")


@dataclass(frozen=True)
class Stage:
    """One quantity of all tests that its recipe takes.

    Attributes:
        symbol: Of the paper.
        name: In words.
        unit: SI.
        rule: Which tests were taken, and by which rule.
        window: Points that were used.
        grid: Other choices of points.
        readings: One a test, where the recipe gave something.
        left_out: Test → why it gave nothing.
    """

    symbol: str
    name: str
    unit: str
    rule: str
    window: Window
    grid: tuple[Window, ...]
    readings: tuple[Reading, ...]
    left_out: dict[str, str]

    @property
    def spread(self) -> float:
        """Median over the tests of how far the choice of points moves the value, in parts of it."""
        moved = [r.spread / abs(r.value) for r in self.readings if np.isfinite(r.spread)]
        return float(np.median(moved)) if moved else float("nan")


def read_tests(
    loops: Loops,
    tests: Sequence[int],
    window: Window,
    grid: tuple[Window, ...],
    measure: Measure,
) -> tuple[tuple[Reading, ...], dict[str, str]]:
    """Read one quantity off some tests.

    Args:
        loops: Of the campaign.
        tests: Which of them.
        window: Points to use.
        grid: Other choices of points.
        measure: The recipe.

    Returns:
        What was read; and for each test that gave nothing, why.
    """
    readings, left_out = [], {}
    for n in tests:
        found = measure(loops, n, window)
        if isinstance(found, str):
            left_out[loops.ids[n]] = found
        else:
            readings.append(_reading(loops, n, found, [measure(loops, n, w) for w in grid]))
    return tuple(readings), left_out


def slope_and_intercept(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least-squares lines along the last axis of [..., n]; leading axes broadcast.

    Returns:
        [...] slope and intercept.
    """
    mean_x, mean_y = x.mean(axis=-1, keepdims=True), y.mean(axis=-1, keepdims=True)
    from_mean = x - mean_x
    slope = (from_mean * (y - mean_y)).sum(axis=-1) / (from_mean**2).sum(axis=-1)
    return np.asarray(slope), np.asarray(mean_y[..., 0] - slope * mean_x[..., 0])


def _reading(loops: Loops, n: int, found: Found, others: Sequence[Found | str]) -> Reading:
    half = found.half_difference
    cycles = found.cycles.size
    if cycles > 1:
        se, replicates = float(found.cycles.std(ddof=1)) / cycles**0.5, cycles
    else:
        se, replicates = abs(half), 2 if np.isfinite(half) else 1
    return Reading(
        test=int(n),
        id=loops.ids[n],
        current=float(loops.current[n]),
        temperature=float(loops.temperature[n]),
        value=float(found.value),
        se=se,
        replicates=replicates,
        half_difference=float(half),
        offset=float(found.offset),
        used=found.used,
        choices=np.array([np.nan if isinstance(z, str) else z.value for z in others]),
    )
