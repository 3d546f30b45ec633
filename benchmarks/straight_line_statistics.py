"""Do intervals of lines cover, and do their tests give false alarms as often as they say?"""

from typing import Final

import numpy as np
from outcome import Outcome

from sysid.identification.straight_lines.curvature import curvature_of
from sysid.identification.straight_lines.lines import Line, fit_line

T: Final = np.array([11.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 67.0, 75.0])
INTERCEPT, SLOPE = 1734.0, -8.91
NOISE: Final = 8.0
"""Standard error that the tests truly have."""
CYCLES: Final = 10


def drawn_line(
    rng: np.random.Generator, *, claimed: float = 1.0, scatter: float = 0.0, bend: float = 0.0
) -> Line:
    """A line through tests of known truth.

    Args:
        rng: Source of the errors.
        claimed: Standard errors that are told, over those that are true.
        scatter: Between tests, beyond the standard errors.
        bend: Of the truth between its ends, in the middle.
    """
    u = (2.0 * T - T.min() - T.max()) / np.ptp(T)
    true = INTERCEPT + SLOPE * T + bend * (1.0 - u**2)
    y = true + NOISE * rng.standard_normal(T.size) + scatter * rng.standard_normal(T.size)
    freedom = CYCLES - 1
    told = claimed * NOISE * np.sqrt(rng.chisquare(freedom, T.size) / freedom)
    return fit_line(T, y, told, np.full(T.size, float(CYCLES)))


def coverage(count: int, *, claimed: float = 1.0, scatter: float = 0.0) -> tuple[float, float]:
    """Shares of 95 % intervals of intercept and slope that hold the truth."""
    rng = np.random.default_rng(5)
    hits = np.zeros(2)
    for _ in range(count):
        (a, b), (c, d) = drawn_line(rng, claimed=claimed, scatter=scatter).intervals
        hits += (a <= INTERCEPT <= b, c <= SLOPE <= d)
    return float(hits[0]) / count, float(hits[1]) / count


def alarms(count: int, **how: float) -> float:
    """Share of lines that are said to bend."""
    rng = np.random.default_rng(6)
    return float(np.mean([curvature_of(drawn_line(rng, **how)).shown for _ in range(count)]))


def statistics(outcome: Outcome, count: int) -> None:
    """Add the tables to a page."""
    cases = (
        ("as they are", {}),
        ("as they are, and as much scatter again", {"scatter": NOISE}),
        ("a third of it: too narrow, the scatter takes it up", {"claimed": 1 / 3}),
        ("three times it: too wide, and stays so", {"claimed": 3.0}),
    )
    outcome.say(
        f"{count} lines of 13 tests each, with known truth: how often 95 % intervals hold it, when",
        "the standard errors that are told are",
    )
    rows = [(name, *(f"{100 * z:.1f} %" for z in coverage(count, **how))) for name, how in cases]
    outcome.table(("standard errors told", "intercept", "slope"), rows)
    few = count // 4
    bends = [(0.0, 0.0), (0.0, NOISE), (NOISE, 0.0), (2 * NOISE, 0.0)]
    found = [alarms(few, bend=bend, scatter=scatter) for bend, scatter in bends]
    outcome.say(
        f"Curvature is told (5 % wanted where there is none) in {100 * found[0]:.1f} % of {few}",
        f"straight lines, {100 * found[1]:.1f} % with scatter, and in {100 * found[2]:.0f} and",
        f"{100 * found[3]:.0f} % of lines bent by one and two standard errors.",
    )
    outcome.numbers |= {"coverage": rows, "curvature": found}
