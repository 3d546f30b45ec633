"""Motions of the base: filtered noise, and roads."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfilt

from sysid.errors import DataError

CUTOFF: Final = 25.0
"""Hz, of the paper."""
DURATION: Final = 5.0
"""s, of the paper."""
ORDER: Final = 4
"""Of the Butterworth filter; the paper does not say."""
LEVEL: Final = 1.3e-3
"""m RMS of the base: the piston's largest speed is then about 0.5 m/s, which the paper does say."""
_GRID: Final = 1e-3
"""s between the samples that noise is drawn at; in between the motion is a cubic spline."""


@dataclass(frozen=True)
class BaseMotion:
    """Motions of the base as samples, with a cubic spline through them.

    Attributes:
        interval: s between samples.
        displacement: [motions, n] m.
        name: In words.
    """

    interval: float
    displacement: Float[np.ndarray, "motions n"]
    name: str

    @property
    def duration(self) -> float:
        """Of each motion, s."""
        return self.interval * (self.displacement.shape[1] - 1)

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacement and velocity at some times, [motions, …] m and m/s."""
        grid = self.interval * np.arange(self.displacement.shape[1])
        none = np.zeros(self.displacement.shape[0])
        ends = ((1, none), (2, none))
        spline = CubicSpline(grid, self.displacement, axis=1, bc_type=ends)  # type: ignore[arg-type]  # as its manual has it
        return spline(time), spline(time, 1)


def butterworth_motion(
    seeds: Sequence[int],
    *,
    level: float = LEVEL,
    cutoff: float = CUTOFF,
    order: int = ORDER,
    duration: float = DURATION,
) -> BaseMotion:
    """White noise through a low-pass Butterworth filter, from rest.

    Args:
        seeds: One a motion.
        level: Expected RMS displacement once the filter has settled, m.
        cutoff: Hz.
        order: Of the filter; below 3 the acceleration of such a motion has no bound.
        duration: s.

    Raises:
        DataError: A number makes no sense.

    Source:
        BS09 Section 4: white noise, low-pass Butterworth, 25 Hz, 5 s; order and level are ours.
    """
    _refuse(seeds, duration)
    if not (level > 0.0 and 0.0 < cutoff < 0.25 / _GRID and 1 <= order <= 10):
        raise DataError(
            f"no filtered noise with {level:g} m RMS, {cutoff:g} Hz and order {order}",
            advice=f"Give a level above 0, a cut-off below {0.25 / _GRID:g} Hz and order 1 to 10",
        )
    sections = butter(order, cutoff, fs=1.0 / _GRID, output="sos")
    count = round(duration / _GRID) + 1
    impulse = np.zeros(20 * round(1.0 / (cutoff * _GRID)))
    impulse[0] = 1.0
    gain = float(np.linalg.norm(np.asarray(sosfilt(sections, impulse))))
    noise = np.stack([np.random.default_rng(seed).standard_normal(count) for seed in seeds])
    noise[:, 0] = 0.0
    moved = level / gain * np.asarray(sosfilt(sections, noise, axis=1))
    return BaseMotion(
        _GRID, moved, f"noise below {cutoff:g} Hz, order {order}, {1e3 * level:g} mm RMS"
    )


ROADS: Final = {"A": 16e-6, "B": 64e-6, "C": 256e-6, "D": 1024e-6}
"""m³: geometric means of G_d(0.1 cycles/m) of ISO 8608's classes."""


def road_motion(
    seeds: Sequence[int],
    *,
    road: str = "C",
    speed: float = 20.0,
    duration: float = DURATION,
    longest: float = 0.5,
    highest: float = 50.0,
) -> BaseMotion:
    """A road after ISO 8608 at constant speed: a sum of sine waves with random phases.

        G_d(n) = G_d(n_0) (n/n_0)⁻²,    n_0 = 0.1 cycles/m,    f = n V

    Args:
        seeds: One a motion.
        road: Class A to D.
        speed: V, m/s.
        duration: s.
        longest: Lowest frequency, Hz.
        highest: Highest frequency, Hz.

    Raises:
        DataError: A number makes no sense.
    """
    _refuse(seeds, duration)
    if road not in ROADS or not speed > 0.0:
        raise DataError(
            f"no road of class {road!r} at {speed:g} m/s",
            advice=f"Classes are {', '.join(ROADS)}, and the speed is above 0",
        )
    time = _GRID * np.arange(round(duration / _GRID) + 1)
    width = 0.5 / duration
    frequency = np.arange(longest + 0.5 * width, highest, width)
    density = ROADS[road] * (frequency / speed / 0.1) ** -2.0 / speed
    amplitude = np.sqrt(2.0 * density * width)
    angle = 2.0 * np.pi * frequency[:, None] * time
    begins = np.minimum(time / 0.2, 1.0)
    begins = begins**3 * (10.0 - 15.0 * begins + 6.0 * begins**2)
    rows = []
    for seed in seeds:
        phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, frequency.size)
        rows.append(begins * (amplitude @ np.sin(angle + phase[:, None])))
    return BaseMotion(_GRID, np.stack(rows), f"road {road} of ISO 8608 at {speed:g} m/s")


def _refuse(seeds: Sequence[int], duration: float) -> None:
    if not seeds or not 10.0 * _GRID <= duration <= 600.0:
        raise DataError(
            f"no motion of {duration:g} s with {len(seeds)} seeds",
            advice="Give one seed at least, and 0.01 to 600 s",
        )
