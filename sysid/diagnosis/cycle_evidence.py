"""What the cycles of each test hold beyond their mean."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float, Int

from sysid.data.loops import Loops
from sysid.likelihood.compress import HarmonicBasis
from sysid.likelihood.discrepancy_parts import originals

FEWEST_CYCLES: Final = 3
"""Two cycles have no change that repeats itself."""
QUIET: Final = 1e-5
"""Smallest noise that is believed, in parts of the RMS force."""

Cycles = Float[np.ndarray, "test cycle m"]
PerTest = Float[np.ndarray, " test"]


def cycle_numbers(deviations: Float[np.ndarray, "cycle phase"]) -> Int[np.ndarray, " cycle"]:
    """Number of each recorded cycle in its test, from 0; a copy has that of its original."""
    return np.unique(originals(deviations), return_inverse=True)[1]


@dataclass(frozen=True)
class CycleEvidence:
    """Tests of at least three cycles, filled up with zeros to as many cycles as the longest has.

    Attributes:
        tests: [T] their numbers in the campaign.
        rows: T arrays, which of the recorded cycles are no copies.
        counts: [T] how many those are.
        change: [T, C, m] N, each cycle minus the mean over the test's cycles.
        own: [T, C] 1 where the test has that cycle.
        trend: [T, C] straight line over the test's cycles, of mean 0 and length 1.
        shape: [T, m] N, the mean loop without its harmonic 0.
        least: [T] N, smallest noise of a coefficient that is believed.
        condition: [T] number of the condition.
    """

    tests: Int[np.ndarray, " test"]
    rows: tuple[Int[np.ndarray, " own"], ...]
    counts: Int[np.ndarray, " test"]
    change: Cycles
    own: Float[np.ndarray, "test cycle"]
    trend: Float[np.ndarray, "test cycle"]
    shape: Float[np.ndarray, "test m"]
    least: PerTest
    condition: Int[np.ndarray, " test"]

    def centred(self, force: Cycles) -> Cycles:
        """A force of every cycle, N, minus its mean over the cycles of the test."""
        held = force * self.own[:, :, None]
        mean = held.sum(axis=1) / self.counts[:, None]
        return (held - mean[:, None, :]) * self.own[:, :, None]


def gather_cycles(
    loops: Loops, basis: HarmonicBasis, condition: Int[np.ndarray, " loop"]
) -> CycleEvidence | None:
    """Collect what changes from cycle to cycle; None where no test has cycles enough.

    A cycle that is a copy of an earlier one is left out, and the others are numbered without it.

    Args:
        loops: L tests.
        basis: Harmonics.
        condition: [L] number of each test's condition.
    """
    changes, rows = [], []
    for deviations in loops.deviations:
        c = basis.compress(deviations)
        rows.append(np.flatnonzero(originals(c) == np.arange(len(c))))
        changes.append(c[rows[-1]] - c[rows[-1]].mean(axis=0))
    tests = np.flatnonzero([len(c) >= FEWEST_CYCLES for c in changes])
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
        rows=tuple(rows[k] for k in tests),
        counts=counts,
        change=change,
        own=own,
        trend=line / np.sqrt(np.sum(line**2, axis=1, keepdims=True)),
        shape=shape,
        least=QUIET * scale,
        condition=condition[tests],
    )
