"""The magnetic circuit: remanence, saturation, eddy currents."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage
from sysid.rig.planters.valve import Values, Valve


@dataclass(frozen=True, kw_only=True)
class Remanence(Planter):
    """The field follows the current as through a play: it remembers the tests before.

    Attributes:
        size: Half width of the hysteresis, as current, A.
    """

    name: ClassVar[str] = "remanence"
    causes: ClassVar[tuple[str, ...]] = ("magnetic_hysteresis",)
    family: ClassVar[str | None] = "current_law"
    stage: ClassVar[Stage] = "drive"
    size: float = 0.015

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them, in the order in which they were run."""
        field = np.zeros_like(state.current)
        before = 0.0
        for k in np.argsort(state.run_order):
            i = float(state.current[k])
            before = min(max(before, i - self.size), i + self.size)
            field[k] = before
        return state.with_valve(current=field[:, None])


@dataclass(frozen=True, kw_only=True)
class MagnetizedCore(Planter):
    """A core that stays magnetized by the same amount in all tests.

    Attributes:
        size: As current, A.
    """

    name: ClassVar[str] = "magnetized_core"
    causes: ClassVar[tuple[str, ...]] = ("residual_magnetism",)
    family: ClassVar[str | None] = "current_law"
    stage: ClassVar[Stage] = "drive"
    size: float = 0.02

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.with_valve(current=state.valve_current + self.size)


@dataclass(frozen=True, kw_only=True)
class SaturatedCore(Planter):
    """Flux that saturates as Fröhlich and Kennelly have it: i / (1 + |i| / i_s).

    Attributes:
        size: 1/i_s, 1/A.
    """

    name: ClassVar[str] = "saturated_core"
    causes: ClassVar[tuple[str, ...]] = ("current_saturation",)
    family: ClassVar[str | None] = "current_law"
    stage: ClassVar[Stage] = "drive"
    size: float = 0.3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        i = state.valve_current
        return state.with_valve(current=i / (1.0 + self.size * np.abs(i)))


@dataclass(frozen=True)
class DraggedField:
    """A valve whose field is dragged along by currents induced in the moving core."""

    inner: Valve
    drag: float

    @property
    def memoryless(self) -> bool:
        """As the valve inside."""
        return self.inner.memoryless

    def force(
        self, velocity: Values, side: Values, peak_velocity: Values, current: Values
    ) -> Values:
        """Force, N; see `Valve.force`."""
        fluid = self.inner.force(velocity, side, peak_velocity, np.zeros_like(current))
        whole = self.inner.force(velocity, side, peak_velocity, current)
        return fluid + (whole - fluid) / (1.0 + self.drag * np.abs(velocity))


@dataclass(frozen=True, kw_only=True)
class EddyCurrents(Planter):
    """Induced currents oppose the field in proportion to speed: B = B_0 / (1 + μ σ d |v|).

    Attributes:
        size: μ σ d of the core, s/m.
    """

    name: ClassVar[str] = "eddy_currents"
    causes: ClassVar[tuple[str, ...]] = ("eddy_loss",)
    family: ClassVar[str | None] = "viscous"
    stage: ClassVar[Stage] = "law"
    size: float = 0.3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.with_valve(valve=DraggedField(state.valve, self.size))
