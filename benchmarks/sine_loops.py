"""Loops of simulated sine tests, as cycles cut from measured ones would be."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from sysid.data.loops import Loops
from sysid.motion.motion import Motion

HARMONICS: Final = 15


def sine_loops(
    ids: Sequence[str],
    motion: Motion,
    force: np.ndarray,
    tests: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None],
    *,
    noise_floor: float = np.nan,
) -> Loops:
    """One steady cycle a test, of which no single cycles are kept.

    Args:
        ids: Of L tests.
        motion: Of them, one cycle each.
        force: [L, J] N.
        tests: [L] each: amplitude m, frequency Hz, current A, temperature °C or None.
        noise_floor: N, of every test; NaN if none is known.
    """
    amplitude, frequency, current, temperature = tests
    count, points = force.shape
    harmonics = np.zeros((count, HARMONICS), dtype=complex)
    harmonics[:, 0] = amplitude
    none = (np.empty((0, points)),) * count
    return Loops(
        ids=tuple(ids),
        displacement=np.array(motion.displacement),
        velocity=np.array(motion.velocity),
        acceleration=np.array(motion.acceleration),
        force=force,
        amplitude=amplitude,
        frequency=frequency,
        current=current,
        temperature=np.full(count, np.nan) if temperature is None else temperature,
        centre=np.zeros(count),
        cycles=np.ones(count, dtype=int),
        noise_floor=np.full(count, noise_floor),
        deviations=none,
        displacement_deviations=none,
        harmonics=harmonics,
    )
