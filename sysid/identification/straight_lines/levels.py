"""What was meant to be the same condition: currents and excitations, grouped by their gaps."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log
from typing import Final

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.straight_lines.stage import Reading

CURRENT_GAP: Final = 0.03
"""A, between two currents that were meant to differ; and beside it 3 % of the larger."""
FREQUENCY_GAP: Final = 0.05
"""In parts, between two frequencies that were meant to differ."""
AMPLITUDE_GAP: Final = 0.15
"""In parts, between two amplitudes: actuators miss amplitude more than frequency."""
ALIKE: Final = 1.0 / 3.0
"""Of a gap: what steps within a level stay below, where neighbours chain to more than a gap."""


@dataclass(frozen=True)
class Excitation:
    """Tests of one amplitude and frequency.

    Attributes:
        amplitude: m, median.
        frequency: Hz, median.
        tests: Places among the loops.
    """

    amplitude: float
    frequency: float
    tests: tuple[int, ...]

    @property
    def peak_velocity(self) -> float:
        """Aω, m/s."""
        return 2.0 * np.pi * self.frequency * self.amplitude

    def is_near(self, amplitude: float, frequency: float) -> bool:
        """Whether it is what somebody means by an amplitude (m) and a frequency (Hz)."""
        return (
            abs(log(self.amplitude / amplitude)) < AMPLITUDE_GAP
            and abs(log(self.frequency / frequency)) < FREQUENCY_GAP
        )

    def __str__(self) -> str:
        return f"{1e3 * self.amplitude:.3g} mm at {self.frequency:.3g} Hz"


def excitations(loops: Loops, amplitude_gap: float = AMPLITUDE_GAP) -> tuple[Excitation, ...]:
    """The amplitudes and frequencies of a campaign, slowest first.

    Args:
        loops: L tests.
        amplitude_gap: In parts, between two amplitudes that were meant to differ.
    """
    found = []
    for same in grouped(np.log(loops.frequency), FREQUENCY_GAP):
        for inner in grouped(np.log(loops.amplitude[same]), amplitude_gap):
            tests = np.sort(same[inner])
            found.append(
                Excitation(
                    float(np.median(loops.amplitude[tests])),
                    float(np.median(loops.frequency[tests])),
                    tuple(tests.tolist()),
                )
            )
    return tuple(sorted(found, key=lambda e: (e.peak_velocity, e.amplitude)))


def current_levels(current: np.ndarray) -> list[tuple[float, np.ndarray]]:
    """Currents that were meant, lowest first, each with the places that have it.

    Args:
        current: [n] A, none of them NaN.

    Returns:
        (A, [m] places) of each level.
    """
    magnitude = np.abs(current)
    gap = CURRENT_GAP * (1.0 + magnitude)
    return [(float(np.median(magnitude[g])), np.sort(g)) for g in grouped(magnitude, gap)]


def amperes(current: float) -> str:
    """A measured current, A, as it was meant: to the milliampere, and never minus zero."""
    return f"{round(current, 3) + 0.0:.3g}"


def by_current(readings: Sequence[Reading]) -> list[tuple[float, list[Reading]]]:
    """Readings by the current that was meant, lowest first."""
    if not readings:
        return []
    found = current_levels(np.array([r.current for r in readings]))
    return [(z, [readings[k] for k in places]) for z, places in found]


def grouped(values: np.ndarray, gap: float | np.ndarray) -> list[np.ndarray]:
    """Places of values that were meant to be one, lowest group first.

    Neighbours closer than a gap chain.  A chain wider than the gap is no scatter of one value: it
    is cut at every step that is wide for a step within a level, or else near its middle.

    Args:
        values: [n]
        gap: Between two values that were meant to differ, for all or [n] for each.

    Returns:
        Of every group, [k] places in `values`.
    """
    if not values.size:
        return []
    order = np.argsort(values, kind="stable")
    wide = np.broadcast_to(gap, values.shape)[order]
    chains = np.split(np.arange(order.size), np.flatnonzero(np.diff(values[order]) > wide[1:]) + 1)
    return [order[part] for chain in chains for part in _levels(values[order], wide, chain)]


def _levels(values: np.ndarray, gap: np.ndarray, chain: np.ndarray) -> list[np.ndarray]:
    """Parts of a chain of places, none wider than its gap; values are in order."""
    inside = values[chain]
    if chain.size < 2 or inside[-1] - inside[0] <= gap[chain].max():
        return [chain]
    steps = np.diff(inside)
    cuts = np.flatnonzero(steps > ALIKE * gap[chain][1:]) + 1
    if cuts.size == 0:
        middle = 0.5 * (inside[1:] + inside[:-1]) - 0.5 * (inside[0] + inside[-1])
        central = np.abs(middle) <= 0.25 * (inside[-1] - inside[0])
        cuts = np.array([int(np.argmax(np.where(central, steps, -1.0))) + 1])
    return [z for part in np.split(chain, cuts) for z in _levels(values, gap, part)]
