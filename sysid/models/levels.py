"""At which currents and temperatures a campaign was measured: what laws given as tables need."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.data.supply import same_current
from sysid.motion.motion import Motion

SWEPT: Final = 5
"""Currents of a table where no test keeps its current."""
SPAN: Final = 5.0
"""K; temperatures that differ by less are one.  Thermocouples err by 1.5 K, and what warms up a
little from test to test has as little to do with temperature as with all else that changed."""


@dataclass(frozen=True)
class Levels:
    """Currents and temperatures of a campaign.

    Attributes:
        currents: A, settings of the supply, increasing, written as `%g` writes them.
        temperatures: Coldest and warmest, °C; None where no test knows its temperature.
        untold: How many tests do not know their temperature.
        tests: How many there are.
    """

    currents: tuple[float, ...]
    temperatures: tuple[float, float] | None
    untold: int
    tests: int

    @property
    def warmed(self) -> bool:
        """There are temperatures far enough apart to see what they change."""
        return self.temperatures is not None and float(np.ptp(self.temperatures)) >= SPAN


def levels_of(motions: Sequence[Motion]) -> Levels:
    """Find them.

    Args:
        motions: [L, n] each, of all tests that are fitted.
    """
    rows = [z for m in motions for z in np.abs(np.asarray(m.current))]
    temperatures = [z for m in motions for z in np.asarray(m.temperature)]
    told = [z for z in temperatures if np.isfinite(z).all()]
    return Levels(
        currents=_settings(rows),
        temperatures=(min(map(np.min, told)).item(), max(map(np.max, told)).item())
        if told
        else None,
        untold=len(temperatures) - len(told),
        tests=len(temperatures),
    )


def _settings(currents: Sequence[np.ndarray]) -> tuple[float, ...]:
    """Means of groups of like currents, with no more digits than they need."""
    largest = max(float(z.max()) for z in currents)
    same = same_current(largest)
    kept = sorted(float(z.mean()) for z in currents if np.ptp(z) <= same)
    if not kept:
        lowest = min(float(z.min()) for z in currents)
        kept = np.linspace(lowest, largest, SWEPT).tolist()
    groups: list[list[float]] = []
    for current in kept:
        if groups and current - groups[-1][0] <= same:
            groups[-1].append(current)
        else:
            groups.append([current])
    return tuple(_written(group, 0.25 * same) for group in groups)


def _written(group: Sequence[float], tolerance: float) -> float:
    """A group's current: as it was given where all agree, else rounded within the tolerance."""
    exact = float(f"{group[0]:g}")
    if max(group) == min(group) and abs(exact - group[0]) <= 1e-12:
        return exact
    mean = float(np.mean(group))
    digits = next((d for d in range(6) if abs(round(mean, d) - mean) <= tolerance), 6)
    return float(f"{round(mean, digits):g}")
