"""Effects that build up within a test or over the campaign."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.fluid_law import ScaledFluid, vogel_ratio
from sysid.rig.planters.planter import Planter, Stage

Cycles = Float[np.ndarray, "loop cycle phase"]

OIL_SLOPE = 5.0e-3
"""−d ln η/dT of the carrier oil at 40 °C, 1/K."""


def adding_cycles(state: BenchState, extra: Cycles) -> BenchState:
    """The tests with a force that differs from cycle to cycle, [L, C, P] N."""
    mean = extra.mean(axis=1)
    departures = extra - mean[:, None, :]
    if state.departures is not None:
        departures = departures + state.departures
    return replace(state, force=state.force + mean, departures=departures)


@dataclass(frozen=True, kw_only=True)
class HeatedOil(Planter):
    """Oil that the damper's own work heats: m c Ṫ = F v − h (T − T_a), T_a as recorded.

    The recorded temperature is that of the body, which does not follow within a test.

    Attributes:
        size: 1/(m c), K/J.
        loss: h/(m c), 1/s.
    """

    name: ClassVar[str] = "heated_oil"
    causes: ClassVar[tuple[str, ...]] = ("self_heating",)
    family: ClassVar[str | None] = "thermal"
    stage: ClassVar[Stage] = "force"
    size: float = 1.0e-3
    loss: float = 5.0e-3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them; a test starts at the body's temperature."""
        warmer = self.rise(state)
        ambient = state.temperature[:, None, None]
        ratio = vogel_ratio(ambient + warmer, OIL_SLOPE) / vogel_ratio(ambient, OIL_SLOPE)
        return adding_cycles(state, (ratio - 1.0) * state.fluid_part()[:, None, :])

    def rise(self, state: BenchState) -> Cycles:
        """T − T_a, [L, C, P] K."""
        loops, points = state.force.shape
        heating = self.size * np.tile(state.force * state.velocity, (1, state.cycles))
        dt = state.time_step[:, None]
        kept = np.exp(-self.loss * dt)
        gained = np.ascontiguousarray(((1.0 - kept) / self.loss * heating).T)
        rise = np.zeros((gained.shape[0] + 1, loops))
        for j in range(gained.shape[0]):
            rise[j + 1] = kept[:, 0] * rise[j] + gained[j]
        return rise[:-1].T.reshape(loops, state.cycles, points)


@dataclass(frozen=True, kw_only=True)
class SettledParticles(Planter):
    """Particles that settled while the damper stood, stirred up again by travel.

    Attributes:
        size: Extra friction at the start, N.
        stirring: Travel that leaves 1/e of it, as a multiple of a cycle's travel.
    """

    name: ClassVar[str] = "settled_particles"
    causes: ClassVar[tuple[str, ...]] = ("first_cycle_breakaway",)
    family: ClassVar[str | None] = "run_history"
    stage: ClassVar[Stage] = "force"
    size: float = 60.0
    stirring: float = 1.5

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        whole = np.abs(state.velocity).sum(axis=1)[:, None]
        share = (np.cumsum(np.abs(state.velocity), axis=1) / whole)[:, None, :]
        travel = np.arange(state.cycles)[None, :, None] + share
        slip = np.tanh(state.velocity / 1e-3)[:, None, :]
        return adding_cycles(state, self.size * np.exp(-travel / self.stirring) * slip)


@dataclass(frozen=True, kw_only=True)
class WornGap(Planter):
    """Wear in proportion to the work done in all tests before: the damper loses strength.

    Attributes:
        size: Share lost over the campaign.
        duration: Of a test, s.
    """

    name: ClassVar[str] = "worn_gap"
    causes: ClassVar[tuple[str, ...]] = ("run_drift",)
    family: ClassVar[str | None] = "run_history"
    stage: ClassVar[Stage] = "law"
    size: float = 0.05
    duration: float = 20.0

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them, in the order in which they were run."""
        order = np.argsort(state.run_order)
        power = np.mean(state.force * state.velocity, axis=1)
        done = np.concatenate([[0.0], np.cumsum(power[order] * self.duration)])
        left = np.empty_like(power)
        left[order] = 1.0 - self.size * done[:-1] / done[-1]
        factor = left[:, None]
        return state.with_valve(valve=ScaledFluid(state.valve, factor, factor))


@dataclass(frozen=True, kw_only=True)
class BodyThermometer(Planter):
    """The thermometer sits on the body: the oil is warmer by what the heat flow needs.

    Attributes:
        size: Thermal resistance from oil to body, K/W.
    """

    name: ClassVar[str] = "body_thermometer"
    causes: ClassVar[tuple[str, ...]] = ("surface_temperature",)
    family: ClassVar[str | None] = "thermal"
    stage: ClassVar[Stage] = "law"
    size: float = 0.05

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        power = np.mean(state.force * state.velocity, axis=1)
        body = state.temperature
        ratio = vogel_ratio(body + self.size * power, OIL_SLOPE) / vogel_ratio(body, OIL_SLOPE)
        factor = ratio[:, None]
        return state.with_valve(valve=ScaledFluid(state.valve, factor, np.ones_like(factor)))
