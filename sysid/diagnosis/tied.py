"""Frequency tied to speed: campaigns in which every speed comes with a frequency of its own."""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops

FREE: Final = 0.1
"""Scatter of ln f about a power of the speed from which frequency counts as varied by itself."""
SAME: Final = 0.05
"""Difference of logarithms below which two amplitudes or frequencies are one."""
OF_FREQUENCY: Final = ("frequency_law",)
OF_SPEED: Final = ("shear_thinning", "quadratic_loss", "eddy_loss")
"""Laws of speed that a law of frequency cannot be told from in such tests."""


def frequency_is_tied(loops: Loops) -> bool:
    """No two tests of one speed differ in frequency, or hardly.

    With one amplitude, or with two excitations, frequency follows from the peak velocity, so what
    depends on the one may as well depend on the other.

    Args:
        loops: L tests.
    """
    speed, frequency = np.log(loops.peak_velocity), np.log(loops.frequency)
    if np.ptp(frequency) < FREE:
        return True
    table = np.stack([speed, np.ones_like(speed)], axis=1)
    left = frequency - table @ np.linalg.lstsq(table, frequency, rcond=None)[0]
    return bool(np.sqrt(np.mean(left**2)) < FREE)


def like_speed(id: str) -> tuple[str, ...]:
    """Effects that stay possible beside one where frequency is tied to speed."""
    if id in OF_FREQUENCY:
        return OF_SPEED
    return OF_FREQUENCY if id in OF_SPEED else ()


def untying_tests(loops: Loops) -> tuple[tuple[float, float], ...]:
    """Amplitude (m) and frequency (Hz) of the tests that would tell frequency from speed.

    The slowest speed at the highest frequency and the fastest one at the lowest, and where the
    campaign has these (a frequency that falls as speed rises) the other way round; where all
    tests have one frequency, the fastest speed at half and at twice that frequency.

    Args:
        loops: L tests.
    """
    speed, frequency = loops.peak_velocity, loops.frequency
    slow, fast = (float(z) for z in (speed.min(), speed.max()))
    low, high = (float(z) for z in (frequency.min(), frequency.max()))
    if np.log(high / low) < FREE:
        low, high, slow = 0.5 * low, 2.0 * high, fast
    corners = ((fast, low), (slow, high), (fast, high), (slow, low))
    wanted = [(v, f) for v, f in dict.fromkeys(corners) if not _done(loops, v, f)]
    return tuple((v / (2.0 * np.pi * f), f) for v, f in wanted[:2])


def _done(loops: Loops, speed: float, frequency: float) -> bool:
    """The campaign has such a test."""
    asked: Float[np.ndarray, 2] = np.log([speed, frequency])
    have = np.log(np.stack([loops.peak_velocity, loops.frequency], axis=1))
    return bool((np.abs(have - asked) < SAME).all(axis=1).any())


def untying_words(loops: Loops) -> str:
    """Those tests as an engineer would ask for them."""
    tests = [f"{1e3 * a:.2g} mm at {f:.2g} Hz" for a, f in untying_tests(loops)]
    return f"the same speeds at other frequencies: {' and '.join(tests)}, at every current"
