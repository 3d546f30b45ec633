"""A mount that gives way between rod and actuator."""

from dataclasses import dataclass
from typing import ClassVar

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage
from sysid.rig.planters.series import valve_behind


@dataclass(frozen=True, kw_only=True)
class SoftMount(Planter):
    """A linear spring in series: ẋ = u + Ḟ(u) / k, solved as a differential equation.

    Attributes:
        size: Compliance 1/k, m/N.
    """

    name: ClassVar[str] = "soft_mount"
    causes: ClassVar[tuple[str, ...]] = ("series_compliance",)
    family: ClassVar[str | None] = "timing"
    stage: ClassVar[Stage] = "motion"
    size: float = 1.0e-7

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        if self.size == 0.0:
            return state
        u = valve_behind(state, lambda force: self.size * force)
        return state.with_valve(velocity=u)
