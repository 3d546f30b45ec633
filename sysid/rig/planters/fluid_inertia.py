"""The oil in the annular gap has to be accelerated."""

from dataclasses import dataclass
from typing import ClassVar

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class OilColumn(Planter):
    """Pressure drop ρ L_g ü_g over the gap, on the piston: ρ L_g (A_p / A_g) A_p a.

    Attributes:
        size: Length of the gap, m.
        density: kg/m³.
        piston_area: m².
        gap_area: m².
    """

    name: ClassVar[str] = "oil_column"
    causes: ClassVar[tuple[str, ...]] = ("fluid_inertia",)
    family: ClassVar[str | None] = "reactive"
    stage: ClassVar[Stage] = "force"
    size: float = 0.03
    density: float = 3000.0
    piston_area: float = 1.2e-3
    gap_area: float = 8.0e-5

    @property
    def mass(self) -> float:
        """Of the oil as the piston feels it, kg."""
        return self.density * self.size * self.piston_area**2 / self.gap_area

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.adding(self.mass * state.acceleration)
