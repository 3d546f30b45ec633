"""A rubber stop near the ends of the stroke."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class RubberStop(Planter):
    """F_e (e^((|x| − x_b) / λ) − 1) beyond x_b, at both ends.

    Attributes:
        size: F_e, N.
        reach: x_b as a share of the widest stroke of the campaign.
        hardening: λ as a share of that stroke.
    """

    name: ClassVar[str] = "rubber_stop"
    causes: ClassVar[tuple[str, ...]] = ("bump_stop",)
    family: ClassVar[str | None] = "reactive"
    stage: ClassVar[Stage] = "force"
    size: float = 40.0
    reach: float = 0.8
    hardening: float = 0.12

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        widest = float(np.max(state.amplitude))
        into = np.maximum(np.abs(state.displacement) / widest - self.reach, 0.0)
        return state.adding(
            self.size * np.expm1(into / self.hardening) * np.sign(state.displacement)
        )
