"""Effects outside the catalogue: the rig around the damper."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.periodic import through
from sysid.rig.planters.planter import Planter, Stage
from sysid.rig.planters.roots import rising_root


@dataclass(frozen=True, kw_only=True)
class RingingFixture(Planter):
    """Load cell and fixture resonate: 1 / (1 − (ω/ω_r)² + 2 i ζ ω/ω_r).

    Attributes:
        size: 1/ω_r, s.
        damping: ζ, dimensionless.
    """

    name: ClassVar[str] = "ringing_fixture"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "timing"
    stage: ClassVar[Stage] = "channel"
    size: float = 1.5e-3
    damping: float = 0.05

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        out = through(
            state.force,
            state.frequency,
            lambda w: 1.0 / (1.0 - (w * self.size) ** 2 + 2j * self.damping * w * self.size),
        )
        return state.recording(out)


@dataclass(frozen=True, kw_only=True)
class SlippingClamp(Planter):
    """A clamp that slides above a force, against friction that grows with the slip speed.

    F = F_c (1 + b arsinh(|w| / w_0)) sgn w for slip speed w; the valve keeps u = v − w.

    Attributes:
        size: Share of the campaign's highest force by which F_c lies below it.
        growth: b.
        slip_speed: w_0, m/s.
    """

    name: ClassVar[str] = "slipping_clamp"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "lost_motion"
    stage: ClassVar[Stage] = "motion"
    size: float = 0.3
    growth: float = 0.05
    slip_speed: float = 5.0e-3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        held = (1.0 - self.size) * state.strongest
        v = state.valve_velocity
        sign = np.sign(state.force)
        reach = 2.0 * np.abs(v) + 1e-6

        def excess(w: np.ndarray) -> np.ndarray:
            clamp = held * (1.0 + self.growth * np.arcsinh(w / self.slip_speed))
            return clamp - sign * state.valve_force(velocity=v - sign * w)

        slip = rising_root(excess, np.zeros_like(v), reach)
        return state.with_valve(velocity=v - sign * slip)


@dataclass(frozen=True, kw_only=True)
class RubberBush(Planter):
    """A bush in parallel that hardens with travel: k_3 x³.

    Attributes:
        size: k_3, N/m³.
    """

    name: ClassVar[str] = "rubber_bush"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "reactive"
    stage: ClassVar[Stage] = "force"
    size: float = 3.0e5

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.adding(self.size * state.displacement**3)
