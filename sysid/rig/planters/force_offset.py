"""The charge of a gas chamber pushes the rod out: a constant force."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class GasPreload(Planter):
    """(P_0 − P_a) A_r on the rod.

    Attributes:
        size: Charge above atmosphere, Pa.
        rod_area: m².
    """

    name: ClassVar[str] = "gas_preload"
    causes: ClassVar[tuple[str, ...]] = ("force_offset",)
    family: ClassVar[str | None] = "offset"
    stage: ClassVar[Stage] = "force"
    size: float = 0.3e6
    rod_area: float = 1.0e-4

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.adding(np.full_like(state.force, self.size * self.rod_area))
