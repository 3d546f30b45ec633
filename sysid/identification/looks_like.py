"""What one slip would explain a test that all others contradict: gain, zero, delay, current."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import minimize_scalar

from sysid.data.figures import figure
from sysid.data.loops import Loops
from sysid.models.base import AbstractValve
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion

EXPLAINED: Final = 0.1
"""Part of the squared departure that may be left of a slip that is told."""
ALIKE: Final = 4.0
"""How many times as much as the best slip another one may leave to be told beside it."""
CURRENTS: Final = 41
"""Currents that are tried between the least and the largest of the others."""

Force = Float[np.ndarray, " phase"]


def looks_like(
    valve: AbstractValve,
    loops: Loops,
    k: int,
    kept: Bool[np.ndarray, " loop"],
    *,
    spread: float,
    statics_free: bool,
) -> tuple[str, ...]:
    """Clauses for people, the best first; those that explain the test about equally well.

    Args:
        valve: Fitted to the others.
        loops: All L tests.
        k: Place of the test.
        kept: [L] the others.
        spread: RMSE/max|F| by which that model errs on the others at most: what leaves no more
            explains the test.
        statics_free: Each test has a static force of its own, which says nothing.
    """
    peak = float(np.abs(loops.force[k]).max())
    force, told = loops.force[k], simulate(valve, loop_motion(loops.select(np.array([k]))))[0]
    force, told = (_about(np.asarray(z), statics_free) for z in (force, told))
    departure = float(np.sum((force - told) ** 2))
    slips = [
        *_of_channel(force, told, float(loops.frequency[k])),
        *_of_current(valve, loops, k, kept, statics_free),
    ]
    slips = sorted(slip for slip in slips if slip[0] <= EXPLAINED * departure)
    if not slips:
        return ()
    noise = force.size * (spread * peak) ** 2
    return tuple(words for left, words in slips if left <= max(ALIKE * slips[0][0], noise))


def _of_channel(force: Force, told: Force, frequency: float) -> Iterator[tuple[float, str]]:
    """(what is left, clause) for a gain, a zero and a delay of the force."""
    gain = float(force @ told / (told @ told))
    yield _left(force, gain * told), f"its force were {figure(gain, 3)} times what they tell"
    zero = float(np.mean(force - told))
    done = "added to" if zero > 0.0 else "taken off"
    yield _left(force, told + zero), f"{figure(abs(zero), 2)} N were {done} its force"
    part, left = _delay(force, told)
    late = "late" if part > 0.0 else "early"
    yield left, f"its force came {figure(1e3 * abs(part) / frequency, 2)} ms {late}"


def _delay(force: Force, told: Force) -> tuple[float, float]:
    """The delay, as a part of a period within ± 1/2, and what it leaves."""
    turns, step = np.fft.rfftfreq(force.size, 1.0 / force.size), 1.0 / force.size
    spectrum = np.fft.rfft(told)
    alike = np.fft.irfft(np.fft.rfft(force) * spectrum.conj(), n=force.size)
    best = (step * int(np.argmax(alike)) + 0.5) % 1.0 - 0.5

    def left(part: float) -> float:
        moved = np.fft.irfft(spectrum * np.exp(-2j * np.pi * turns * part), n=force.size)
        return _left(force, moved)

    found: Any = minimize_scalar(left, bounds=(best - step, best + step), method="bounded")
    return float(found.x), float(found.fun)


def _of_current(
    valve: AbstractValve,
    loops: Loops,
    k: int,
    kept: Bool[np.ndarray, " loop"],
    statics_free: bool,
) -> Iterator[tuple[float, str]]:
    """(what is left, clause) for another current; nothing where the others have one alone."""
    others = np.abs(loops.current[kept])
    if not np.ptp(others) > 0.0:
        return
    currents = np.linspace(others.min(), others.max(), CURRENTS)
    same = loops.select(np.full(CURRENTS, k))
    forces = np.asarray(simulate(valve, loop_motion(replace(same, current=currents))))
    excess = _about(loops.force[k] - forces, statics_free)
    left = np.sum(excess**2, axis=1)
    best = int(np.argmin(left))
    yield (
        float(left[best]),
        f"its current were {figure(float(currents[best]), 2)} A instead of "
        f"{figure(float(loops.current[k]), 2)} A",
    )


def _about(force: np.ndarray, mean: bool) -> np.ndarray:
    """Forces [..., J], about their means if asked."""
    return force - force.mean(axis=-1, keepdims=True) if mean else force


def _left(force: Force, explained: Force) -> float:
    return float(np.sum((force - explained) ** 2))
