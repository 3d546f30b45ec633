"""The gas charge follows the absolute temperature (ideal gas at constant volume)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class WarmGas(Planter):
    """P_0 A_r (T − T_fill) / T_fill, where the cell was zeroed at the filling temperature.

    Attributes:
        size: Charge, absolute, Pa.
        rod_area: m².
        filling_temperature: °C.
    """

    name: ClassVar[str] = "warm_gas"
    causes: ClassVar[tuple[str, ...]] = ("gas_temperature",)
    family: ClassVar[str | None] = "offset"
    stage: ClassVar[Stage] = "force"
    size: float = 2.0e6
    rod_area: float = 1.0e-4
    filling_temperature: float = 40.0

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        warmer = state.temperature[:, None] - self.filling_temperature
        extra = self.size * self.rod_area * warmer / (self.filling_temperature + 273.15)
        return state.adding(np.broadcast_to(extra, state.force.shape))
