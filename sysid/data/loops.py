"""Steady cycles of many tests on one phase grid: what a fit compares a model with."""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from sysid.errors import DataError

if TYPE_CHECKING:
    import pandas as pd

LoopArray = Float[np.ndarray, "loop phase"]
PerLoop = Float[np.ndarray, " loop"]


@dataclass(frozen=True)
class Loops:
    """Cycle means of L sinusoidal tests, stacked.

    Phase φ is that of the fundamental of the measured displacement: x₁ = A sin φ.  The grid is
    φ_j = 2π j / J, j = 0 … J−1.  Displacement is relative to its centre in the test; velocity and
    acceleration are its Fourier derivatives.

    Attributes:
        ids: L ids of records.
        displacement: [L, J] m, relative to the centre.
        velocity: [L, J] m/s.
        acceleration: [L, J] m/s².
        force: [L, J] N, cycle mean.
        amplitude: [L] m, of the fundamental.
        frequency: [L] Hz, as measured.
        current: [L] A (NaN where unknown).
        temperature: [L] °C (NaN where unknown).
        centre: [L] m, mean displacement in the record's own coordinate.
        cycles: [L] number of steady cycles averaged.
        noise_floor: [L] N, RMS over phase of the standard deviation between cycles, per loop
            point of one cycle (NaN with fewer than two cycles).
        deviations: L arrays [cycles, J] N, each cycle's force minus the cycle mean.
        displacement_deviations: L arrays [cycles, J] m, likewise.
        harmonics: [L, 15] m, complex amplitudes of the displacement's harmonics 1 … 15
            (x = Σ Im(h_n e^{i n φ}), so h_1 = A).
        start_phase: [L] rad, phase at which each cycle of `deviations` begins; None where unknown.
    """

    ids: tuple[str, ...]
    displacement: LoopArray
    velocity: LoopArray
    acceleration: LoopArray
    force: LoopArray
    amplitude: PerLoop
    frequency: PerLoop
    current: PerLoop
    temperature: PerLoop
    centre: PerLoop
    cycles: Int[np.ndarray, " loop"]
    noise_floor: PerLoop
    deviations: tuple[Float[np.ndarray, "cycle phase"], ...]
    displacement_deviations: tuple[Float[np.ndarray, "cycle phase"], ...]
    harmonics: np.ndarray
    start_phase: PerLoop | None = None

    @property
    def peak_velocity(self) -> PerLoop:
        """v_m = A ω of each loop, [L] m/s (the reading of W11 Eq. 10 for loops)."""
        return 2.0 * np.pi * self.frequency * self.amplitude

    @property
    def mean_cycle_noise(self) -> PerLoop:
        """`noise_floor` over √`cycles`, [L] N: what a perfect model would leave of the force."""
        return self.noise_floor / np.sqrt(self.cycles)

    def select(self, which: np.ndarray) -> "Loops":
        """The same with some tests only.

        Args:
            which: [L] booleans, or indices in the wanted order.
        """
        index = np.arange(len(self.ids))[which]
        changed = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None:
                changed[field.name] = (
                    tuple(value[k] for k in index) if isinstance(value, tuple) else value[index]
                )
        return Loops(**changed)

    def joined(self, other: "Loops") -> "Loops":
        """These tests and then those of another campaign on the same phase grid.

        Args:
            other: With as many points a loop and other ids.

        Raises:
            DataError: The grids differ, or an id stands in both.
        """
        if self.force.shape[1] != other.force.shape[1]:
            raise DataError(
                f"loops of {self.force.shape[1]} and of {other.force.shape[1]} points cannot be "
                "joined",
                advice="Cut both with the same number of points",
            )
        if twice := set(self.ids) & set(other.ids):
            raise DataError(f"{sorted(twice)[0]} stands in both campaigns", advice="Rename it")
        joined = {}
        for field in fields(self):
            mine, theirs = getattr(self, field.name), getattr(other, field.name)
            if isinstance(mine, tuple):
                joined[field.name] = (*mine, *theirs)
            elif mine is not None and theirs is not None:
                joined[field.name] = np.concatenate([mine, theirs])
        return Loops(**joined)

    def to_frame(self) -> "pd.DataFrame":
        """One row a test, indexed by id, units in the column names."""
        import pandas as pd

        return pd.DataFrame(
            {
                "amplitude_m": self.amplitude,
                "frequency_Hz": self.frequency,
                "peak_velocity_m/s": self.peak_velocity,
                "current_A": self.current,
                "temperature_degC": self.temperature,
                "centre_m": self.centre,
                "cycles": self.cycles,
                "peak_force_N": np.abs(self.force).max(axis=1, initial=0.0),
                "noise_floor_N": self.noise_floor,
            },
            index=pd.Index(self.ids, name="id"),
        )
