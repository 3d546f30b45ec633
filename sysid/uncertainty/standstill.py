"""Where a motion comes to rest between two samples, and what a force is there.

A damper's force may jump where the velocity changes its sign: gas and friction act on the other
side, and the stiffness of compression takes the place of the one of extension (`k_1c`, `k_1e`).  A
sample that lies within rounding of the standstill is on one side of the jump or the other by
chance, and the mean of a phase bin there is of both.  So the force at standstill is read off the
samples around it, a cubic through two on either side, and the one at rest is left out: where the
force runs smoothly that is its value, and where it jumps the middle of the jump.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float, Int

_NEAR: Final = 0.25
"""Steps of time; a sample that is nearer to the standstill is left out."""
_AROUND: Final = np.array([-2.0, -1.0, 1.0, 2.0])
"""Samples about the one that is left out."""
_BETWEEN: Final = np.array([-1.0, 0.0, 1.0, 2.0])
"""Samples about a standstill between two, from the last one before it."""


@dataclass(frozen=True)
class Standstill:
    """Standstills of a kind, c in all, and how to read a force there.

    Attributes:
        loop: [c] which test.
        samples: [c, 4] of its force.
        weights: [c, 4] of these.
        tests: L.
    """

    loop: Int[np.ndarray, " c"]
    samples: Int[np.ndarray, "c four"]
    weights: Float[np.ndarray, "c four"]
    tests: int

    def mean(self, force: Float[np.ndarray, "draw loop point"]) -> Float[np.ndarray, "draw loop"]:
        """Of the force at all standstills of a test, N; NaN in a test without any."""
        there = force[:, self.loop[:, None], self.samples]
        read = np.einsum("dck,ck->dc", there, self.weights)
        own = self.loop[:, None] == np.arange(self.tests)
        count = own.sum(axis=0)
        return np.where(count > 0, read @ own / np.maximum(count, 1), np.nan)


def standstills(
    velocity: Float[np.ndarray, "loop point"], *, periodic: bool, falling: bool
) -> Standstill:
    """Where a motion comes to rest and turns back.

    Args:
        velocity: m/s, evenly sampled.
        periodic: Its last sample is followed by its first.
        falling: Standstills in which the velocity falls through 0; else those in which it rises.
    """
    v = velocity if falling else -velocity
    tests, points = v.shape
    loop, last = np.nonzero((v > 0.0) & (np.roll(v, -1, axis=1) <= 0.0))
    if not periodic:
        loop, last = loop[last < points - 1], last[last < points - 1]

    def at(sample: np.ndarray) -> np.ndarray:
        return v[loop, sample % points]

    share = at(last) / (at(last) - at(last + 1))
    left_out = np.where(share < _NEAR, last, np.where(share > 1.0 - _NEAR, last + 1, -9))
    near = left_out >= 0
    first = np.where(near, left_out, last)
    offsets = np.where(near[:, None], _AROUND, _BETWEEN)
    samples = first[:, None] + offsets.astype(np.int64)
    weights = _lagrange(offsets, np.where(near, share - (first - last), share))
    around = v[loop[:, None], samples % points]
    plain = ~((around[:, :2] > 0.0).all(axis=1) & (around[:, 2:] < 0.0).all(axis=1))
    if not periodic:
        plain |= (samples < 0).any(axis=1) | (samples >= points).any(axis=1)
    # No room for a cubic, or a motion that rests or turns back at once: a straight line
    samples[plain] = last[plain, None] + np.array([0, 0, 1, 1])
    weights[plain] = np.stack(
        [1.0 - share[plain], np.zeros(plain.sum()), share[plain], np.zeros(plain.sum())], axis=1
    )
    return Standstill(loop, samples % points, weights, tests)


def _lagrange(
    nodes: Float[np.ndarray, "c four"], place: Float[np.ndarray, " c"]
) -> Float[np.ndarray, "c four"]:
    """Weights of values at nodes in their cubic's value at a place."""
    weights = np.ones_like(nodes)
    for j in range(4):
        for k in range(4):
            if k != j:
                weights[:, j] *= (place - nodes[:, k]) / (nodes[:, j] - nodes[:, k])
    return weights
