"""How large a hidden effect is in a campaign, and how to give it a wanted size."""

import math
from dataclasses import replace
from typing import Final

import numpy as np

from sysid.errors import DataError
from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter

CLOSE: Final = 0.005
"""Relative error of the size that is small enough."""
_ROUNDS: Final = 40


def planted_size(planter: Planter, state: BenchState) -> float:
    """RMS over the campaign of the force with minus the force without, over RMS without; %."""
    planted = planter.plant(state)
    power = float(np.mean((planted.force - state.force) ** 2))
    if planted.departures is not None:
        before = 0.0 if state.departures is None else state.departures
        power += float(np.mean((planted.departures - before) ** 2))
    return 100.0 * math.sqrt(power / float(np.mean(state.force**2)))


def scaled_to(planter: Planter, state: BenchState, percent: float) -> Planter:
    """The planter with the `size` that gives a wanted size in a campaign.

    Secant steps on the logarithms; once there is a bracket they stay inside, and every third step
    halves it, because the size of a resonance does not grow evenly.

    Args:
        planter: Its present size, not 0, is where the search starts; the sign is kept.
        state: The tests without the effect.
        percent: `planted_size` that is wanted.

    Raises:
        DataError: No size gives it.
    """
    if percent == 0.0:
        return replace(planter, size=0.0)
    low, high = (-math.inf, math.inf)
    at, slope = math.log(abs(planter.size)), 1.0
    sign = math.copysign(1.0, planter.size)
    before: tuple[float, float] | None = None
    for turn in range(_ROUNDS):
        trial = replace(planter, size=sign * math.exp(at))
        reached = planted_size(trial, state)
        if not reached > 0.0 or not math.isfinite(reached):
            miss = -1.0 if reached == 0.0 else 1.0
        else:
            miss = math.log(reached / percent)
            if abs(miss) < CLOSE:
                return trial
        if before is not None and abs(at - before[0]) > 1e-12:
            slope = min(max((miss - before[1]) / (at - before[0]), 0.25), 4.0)
        before = (at, miss)
        low, high = (at, high) if miss < 0.0 else (low, at)
        step = at - min(max(miss / slope, -1.5), 1.5)
        if math.isfinite(low + high) and (turn % 3 == 2 or not low < step < high):
            step = 0.5 * (low + high)
        at = step
    raise DataError(
        f"{planter.name} cannot be given a size of {percent:g} % in this campaign",
        advice="Choose a smaller size, or other tests",
    )
