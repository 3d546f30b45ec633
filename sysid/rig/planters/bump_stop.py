"""A rubber stop near the ends of the stroke."""

from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from sysid.errors import DataError
from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage

_SOLID: Final = 8.0
"""Times λ into the rubber: three thousand times F_e, more than any rig pushes with."""


@dataclass(frozen=True, kw_only=True)
class RubberStop(Planter):
    """F_e (e^((|x| − x_b) / λ) − 1) beyond x_b, at both ends.

    Attributes:
        size: F_e, N.
        reach: x_b as a share of the widest stroke that damper and rig were built for.
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
        """The tests with the effect in them.

        Raises:
            DataError: A test would go through the stop.
        """
        into = np.maximum(np.abs(state.displacement) / state.widest - self.reach, 0.0)
        if float(into.max()) > _SOLID * self.hardening:
            raise DataError(
                f"strokes of {1e3 * state.amplitude.max():.3g} mm go through the rubber stops, "
                f"which are made for {1e3 * state.widest:.3g} mm",
                advice="Ask for shorter strokes",
            )
        return state.adding(
            self.size * np.expm1(into / self.hardening) * np.sign(state.displacement)
        )
