"""Frequency tied to speed: campaigns in which every speed comes with a frequency of its own."""

from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops

FREE: Final = 0.1
"""Scatter of ln f about a power of the speed from which frequency counts as varied by itself."""
SAME: Final = 0.05
"""Difference of logarithms below which two amplitudes or frequencies are one."""
SLOWER: Final = 0.25
"""Of the lowest frequency of a campaign: slower tests are not asked for, they take too long."""
OF_FREQUENCY: Final = ("frequency_law",)
OF_SPEED: Final = ("shear_thinning", "quadratic_loss", "eddy_loss")
"""Laws of speed that a law of frequency cannot be told from in such tests."""


def frequency_is_varied(loops: Loops) -> bool:
    """There are tests at different frequencies: a law of frequency does something in them.

    Args:
        loops: L tests.
    """
    return bool(np.ptp(np.log(loops.frequency)) >= FREE)


def one_frequency(loops: Loops) -> str:
    """That frequency is not varied, in words."""
    low, high = (f"{z:.3g}" for z in (loops.frequency.min(), loops.frequency.max()))
    if low == high:
        return f"all tests are at one frequency ({low} Hz)"
    return f"frequencies differ by less than a tenth ({low} to {high} Hz)"


def frequency_is_tied(loops: Loops) -> bool:
    """Frequencies differ, but hardly in tests of one speed.

    With one amplitude, or with two excitations, frequency follows from the peak velocity, so what
    depends on the one may as well depend on the other.  With one frequency nothing depends on it.

    Args:
        loops: L tests.
    """
    if not frequency_is_varied(loops):
        return False
    speed, frequency = np.log(loops.peak_velocity), np.log(loops.frequency)
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

    One speed at frequencies as far apart as the rig has shown that it can go: at the largest
    amplitude of the campaign (but not below `SLOWER` of its lowest frequency), and at its highest
    frequency.  The slowest speed goes furthest; the next ones are asked for where the campaign has
    those tests.  Two tests at most; where it has
    all of them (one amplitude at one frequency), half and twice that frequency.

    Args:
        loops: L tests.
    """
    largest = float(loops.amplitude.max())
    low, high = (float(z) for z in (loops.frequency.min(), loops.frequency.max()))
    speeds = _levels(loops.peak_velocity)
    wanted = [
        (speed, frequency)
        for speed in speeds
        for frequency in (max(speed / (2.0 * np.pi * largest), SLOWER * low), high)
        if not _done(loops, speed, frequency)
    ]
    if not wanted:
        wanted = [(speeds[-1], f) for f in (0.5 * low, 2.0 * high)]
    return tuple((v / (2.0 * np.pi * f), f) for v, f in wanted[:2])


def _levels(speed: Float[np.ndarray, " L"]) -> tuple[float, ...]:
    """Speeds of a campaign, rising, m/s; those that differ by less than `SAME` are one."""
    rising = np.sort(np.log(speed))
    groups = np.split(rising, 1 + np.flatnonzero(np.diff(rising) > SAME))
    return tuple(float(np.exp(np.median(group))) for group in groups)


def _done(loops: Loops, speed: float, frequency: float) -> bool:
    """The campaign has such a test."""
    asked: Float[np.ndarray, 2] = np.log([speed, frequency])
    have = np.log(np.stack([loops.peak_velocity, loops.frequency], axis=1))
    return bool((np.abs(have - asked) < SAME).all(axis=1).any())


def untying_words(loops: Loops) -> str:
    """Those tests as an engineer would ask for them."""
    tests = [f"{1e3 * a:.2g} mm at {f:.2g} Hz" for a, f in untying_tests(loops)]
    return f"the same speeds at other frequencies: {' and '.join(tests)}, at every current"
