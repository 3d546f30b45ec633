"""Which tests are of one condition: an amplitude and a frequency, with all currents."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from jaxtyping import Int
from scipy.stats import rankdata

from sysid.data.loops import Loops
from sysid.identification.straight_lines.levels import (
    AMPLITUDE_GAP,
    current_levels,
    excitations,
)

FEWEST_LEVELS: Final = 3
"""Currents from which a stroke can be seen to fall with them."""
STEADILY: Final = -0.8
"""Rank correlation of stroke and current below which the one falls with the other."""
SAME_CONDITION: Final = 0.05
"""Amplitudes that agree to 5 % are one: what is held out apart may differ by less than a level."""


def conditions(loops: Loops) -> Int[np.ndarray, " loop"]:
    """Number of the (amplitude, frequency) condition of each test, [L], from 0 as they come.

    Which tests are of one condition does not depend on the order in which they come.  Where the
    stroke of an actuator falls as the damper gets stiffer (`_falls`), tests are of one condition.
    """
    same = [e.tests for e in excitations(loops, SAME_CONDITION)]
    for wide in excitations(loops, AMPLITUDE_GAP):
        inside = [tests for tests in same if set(tests) <= set(wide.tests)]
        if len(inside) > 1 and _falls(loops, inside):
            same = [tests for tests in same if tests not in inside]
            same.append(tuple(sorted(test for tests in inside for test in tests)))
    number = np.empty(len(loops.ids), dtype=int)
    for k, tests in enumerate(sorted(same, key=min)):
        number[list(tests)] = k
    return number


def _falls(loops: Loops, groups: Sequence[tuple[int, ...]]) -> bool:
    """No current is in two groups of amplitudes, and amplitudes fall with current."""
    tests = np.concatenate(groups)
    current, amplitude = np.abs(loops.current[tests]), loops.amplitude[tests]
    if not np.isfinite(current).all():
        return False
    group = np.repeat(np.arange(len(groups)), [len(g) for g in groups])
    levels = current_levels(current)
    if len(levels) < FEWEST_LEVELS or any(np.ptp(group[at]) > 0 for _, at in levels):
        return False
    ranks = np.corrcoef(rankdata(current), rankdata(amplitude))
    return float(ranks[0, 1]) < STEADILY
