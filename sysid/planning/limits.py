"""What rig and damper can do: how far, how fast, how often, with what current and force."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

LOWEST: Final = 0.1
"""Hz, the lowest frequency where the rig's is not known: one cycle in ten seconds."""
HIGHEST: Final = 20.0
"""Hz, the highest one where neither the rig's nor a higher test is known."""
REACH: Final = 0.1
"""Smallest amplitude worth trying, in parts of the smallest that was tested."""


@dataclass(frozen=True)
class Conditions:
    """Conditions of the tests that were done.

    Attributes:
        amplitude: m, smallest and largest.
        frequency: Hz, smallest and largest.
        current: A, all levels, increasing.
        temperature: °C, median; NaN where unknown.
        displacement: m, largest distance from the centre of a test.
        speed: m/s, largest.
        force: N, largest that was measured, of either sign; NaN where unknown.
    """

    amplitude: tuple[float, float]
    frequency: tuple[float, float]
    current: tuple[float, ...]
    temperature: float
    displacement: float
    speed: float
    force: float = math.nan


@dataclass(frozen=True)
class Limits:
    """What a test must stay within.

    Attributes:
        amplitude: m, smallest and largest.
        frequency: Hz, smallest and largest.
        velocity: m/s.
        current: A, levels that may be set.
        force: N, infinite where nothing is known of it.
        assumed: What was not said and how it was taken, in words.
    """

    amplitude: tuple[float, float]
    frequency: tuple[float, float]
    velocity: float
    current: tuple[float, ...]
    force: float = math.inf
    assumed: tuple[str, ...] = ()


def limits_within(
    done: Conditions,
    *,
    stroke: float | None = None,
    velocity: float | None = None,
    current: float | None = None,
    frequency: float | None = None,
    force: float = math.inf,
) -> Limits:
    """Limits of a rig, what is not known of it being that of the tests that were done.

    Args:
        done: Those tests.
        stroke: m, largest distance from the centre.
        velocity: m/s.
        current: A.
        frequency: Hz, largest.
        force: N, largest that rig and load cell bear.
    """
    assumed = []
    if stroke is None:
        stroke = done.displacement
        assumed.append(f"strokes of at most {2e3 * stroke:.3g} mm from end to end, as tested")
    if velocity is None:
        velocity = done.speed
        assumed.append(f"speeds of at most {velocity:.3g} m/s, as tested")
    if current is None:
        current = max(done.current)
        assumed.append(f"currents of at most {current:.3g} A, as tested")
    if frequency is None:
        frequency = max(HIGHEST, done.frequency[1])
        assumed.append(f"frequencies of at most {frequency:.3g} Hz")
    if force == math.inf:
        largest = "" if math.isnan(done.force) else f" (the largest measured is {done.force:.4g} N)"
        assumed.append(f"no limit of the force, as none is known{largest}")
    lowest, smallest = min(LOWEST, done.frequency[0]), REACH * done.amplitude[0]
    assumed.append(
        f"frequencies from {lowest:.3g} Hz and amplitudes from {1e3 * smallest:.3g} mm on"
    )
    levels = {*(i for i in done.current if i <= current), 0.0, current}
    return Limits(
        amplitude=(smallest, stroke),
        frequency=(lowest, frequency),
        velocity=velocity,
        current=tuple(float(i) for i in np.unique(np.round(sorted(levels), 6))),
        force=force,
        assumed=tuple(assumed),
    )
