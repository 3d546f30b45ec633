"""What load cell, amplifier and recorder make of the force."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.periodic import shifted, through
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class LateSampling(Planter):
    """The force channel is sampled later than the displacement channel.

    Attributes:
        size: By how much, s.
    """

    name: ClassVar[str] = "late_sampling"
    causes: ClassVar[tuple[str, ...]] = ("force_delay",)
    family: ClassVar[str | None] = "timing"
    stage: ClassVar[Stage] = "channel"
    size: float = 5.0e-4

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.recording(shifted(state.force, self.size / state.time_step))


@dataclass(frozen=True, kw_only=True)
class ButterworthChannel(Planter):
    """An anti-alias filter of second order on the force only: ω_c² / (s² + √2 ω_c s + ω_c²).

    Attributes:
        size: 1/ω_c, s.
    """

    name: ClassVar[str] = "butterworth_channel"
    causes: ClassVar[tuple[str, ...]] = ("force_filter",)
    family: ClassVar[str | None] = "timing"
    stage: ClassVar[Stage] = "channel"
    size: float = 1.0e-3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        out = through(
            state.force,
            state.frequency,
            lambda w: 1.0 / (1.0 + np.sqrt(2.0) * 1j * w * self.size - (w * self.size) ** 2),
        )
        return state.recording(out)


@dataclass(frozen=True, kw_only=True)
class BentLoadCell(Planter):
    """A load cell that is more sensitive in compression than in tension.

    Attributes:
        size: Half the relative difference of the two gains.
        blend: Force over which one gain passes into the other, N.
    """

    name: ClassVar[str] = "bent_load_cell"
    causes: ClassVar[tuple[str, ...]] = ("asymmetric_gain",)
    family: ClassVar[str | None] = "offset"
    stage: ClassVar[Stage] = "channel"
    size: float = 0.02
    blend: float = 15.0

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        gain = 1.0 + self.size * np.tanh(state.force / self.blend)
        return state.recording(gain * state.force)


@dataclass(frozen=True, kw_only=True)
class ConverterLimit(Planter):
    """The converter's range ends below the highest force.

    Attributes:
        size: Share of the campaign's highest force that is cut off.
    """

    name: ClassVar[str] = "converter_limit"
    causes: ClassVar[tuple[str, ...]] = ("force_clipping",)
    family: ClassVar[str | None] = "acquisition"
    stage: ClassVar[Stage] = "channel"
    size: float = 0.1

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        limit = (1.0 - self.size) * state.strongest
        return state.recording(np.clip(state.force, -limit, limit))


@dataclass(frozen=True, kw_only=True)
class WrongCalibration(Planter):
    """The load cell's factor is wrong; the damper's own scale takes this up.

    Attributes:
        size: Relative error.
    """

    name: ClassVar[str] = "wrong_calibration"
    causes: ClassVar[tuple[str, ...]] = ("load_cell_gain",)
    family: ClassVar[str | None] = "acquisition"
    stage: ClassVar[Stage] = "channel"
    size: float = 0.01

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.recording((1.0 + self.size) * state.force)
