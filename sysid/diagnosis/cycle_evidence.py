"""What the cycles of each test hold beyond their mean."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float, Int

from sysid.data.loops import Loops
from sysid.diagnosis.compress import HarmonicBasis
from sysid.diagnosis.discrepancy_parts import distinct

FEWEST_CYCLES: Final = 3
"""Two cycles have no change that repeats itself."""
QUIET: Final = 1e-5
"""Smallest noise that is believed, in parts of the RMS force."""

Cycles = Float[np.ndarray, "test cycle m"]
PerTest = Float[np.ndarray, " test"]


@dataclass(frozen=True)
class CycleEvidence:
    """Tests of at least three cycles, filled up with zeros to as many cycles as the longest has.

    Attributes:
        tests: [T] their numbers in the campaign.
        counts: [T] their cycles.
        change: [T, C, m] N, each cycle minus the mean over the test's cycles.
        own: [T, C] 1 where the test has that cycle.
        trend: [T, C] straight line over the test's cycles, of mean 0 and length 1.
        shape: [T, m] N, the mean loop without its harmonic 0.
        least: [T] N, smallest noise of a coefficient that is believed.
        condition: [T] number of the condition.
    """

    tests: Int[np.ndarray, " test"]
    counts: Int[np.ndarray, " test"]
    change: Cycles
    own: Float[np.ndarray, "test cycle"]
    trend: Float[np.ndarray, "test cycle"]
    shape: Float[np.ndarray, "test m"]
    least: PerTest
    condition: Int[np.ndarray, " test"]

    def centred(self, force: Cycles) -> Cycles:
        """A force of every cycle minus its mean over the cycles of the test."""
        held = force * self.own[:, :, None]
        mean = held.sum(axis=1) / self.counts[:, None]
        return (held - mean[:, None, :]) * self.own[:, :, None]


def gather_cycles(
    loops: Loops, basis: HarmonicBasis, condition: Int[np.ndarray, " loop"]
) -> CycleEvidence | None:
    """Collect what changes from cycle to cycle; None where no test has cycles enough.

    A test in which one cycle is a copy of another is left out: the numbers of its cycles are not
    those in which they were run.

    Args:
        loops: L tests.
        basis: Harmonics.
        condition: [L] number of each test's condition.
    """
    changes = [basis.compress(d) for d in loops.deviations]
    usable = [len(c) >= FEWEST_CYCLES and len(distinct(c)) == len(c) for c in changes]
    tests = np.flatnonzero(usable)
    if tests.size == 0:
        return None
    counts = np.array([len(changes[k]) for k in tests])
    most = int(counts.max())
    change = np.zeros((tests.size, most, basis.order.size))
    for row, k in enumerate(tests):
        change[row, : counts[row]] = changes[k]
    own = (np.arange(most)[None, :] < counts[:, None]).astype(np.float64)
    line = (np.arange(most)[None, :] - 0.5 * (counts[:, None] - 1)) * own
    shape = basis.compress(loops.force[tests])
    shape[:, basis.order == 0] = 0.0
    scale = np.sqrt(np.mean(loops.force[tests] ** 2, axis=1))
    return CycleEvidence(
        tests=tests,
        counts=counts,
        change=change,
        own=own,
        trend=line / np.sqrt(np.sum(line**2, axis=1, keepdims=True)),
        shape=shape,
        least=QUIET * scale,
        condition=condition[tests],
    )
