"""Tests of equal peak velocity: a test of the model class that needs no fit.

A model that depends on v, sgn ẍ, v_m and i alone predicts the same force over phase for every
pair of amplitude and frequency with the same A·f.  What differs inside such a group is therefore
displacement (gas spring), frequency (inertia, delay, rate laws) or travel (lost motion).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.data.supply import same_current
from sysid.diagnosis.parity import Parity, parity_shares

SAME: Final = 0.02
"""Peak velocities that agree to 2 % are equal; currents are where they are one setting."""
APART: Final = 1.2
"""Amplitudes of a pair differ by at least this factor."""


@dataclass(frozen=True)
class Contrast:
    """Difference of two loops of equal peak velocity and current.

    Attributes:
        slow: Id of the test with the larger amplitude.
        fast: Id of the one with the higher frequency.
        peak_velocity: m/s.
        current: A.
        rms: N, of F_fast − F_slow over phase.
        noise: N, standard deviation that repeatability alone gives that difference; NaN if unknown.
        parity: Share of the difference's energy in each parity.
    """

    slow: str
    fast: str
    peak_velocity: float
    current: float
    rms: float
    noise: float
    parity: dict[Parity, float]

    @property
    def ratio(self) -> float:
        """RMS over noise: about 1 where the model class holds."""
        return self.rms / self.noise


def iso_velocity_contrasts(loops: Loops) -> tuple[Contrast, ...]:
    """All pairs of tests of equal v_m and i but different amplitude, largest ratio first."""
    v_m = loops.peak_velocity
    same = same_current(float(np.abs(loops.current).max()))
    first, second = np.triu_indices(len(loops.ids), k=1)
    slow = np.where(loops.amplitude[first] >= loops.amplitude[second], first, second)
    fast = first + second - slow
    equal = np.abs(np.log(v_m[slow] / v_m[fast])) < SAME
    equal &= np.abs(loops.current[slow] - loops.current[fast]) <= same
    equal &= loops.amplitude[slow] > APART * loops.amplitude[fast]
    noise = loops.mean_cycle_noise
    pairs = [
        _contrast(loops, noise, int(s), int(f))
        for s, f in zip(slow[equal], fast[equal], strict=True)
    ]
    return tuple(sorted(pairs, key=lambda c: -c.rms if np.isnan(c.noise) else -c.ratio))


def _contrast(loops: Loops, noise: Float[np.ndarray, " loop"], slow: int, fast: int) -> Contrast:
    difference = loops.force[fast] - loops.force[slow]
    return Contrast(
        slow=loops.ids[slow],
        fast=loops.ids[fast],
        peak_velocity=float(loops.peak_velocity[slow]),
        current=float(loops.current[slow]),
        rms=float(np.sqrt(np.mean(difference**2))),
        noise=float(np.hypot(noise[slow], noise[fast])),
        parity=parity_shares(difference[None, :]),
    )
