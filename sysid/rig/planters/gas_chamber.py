"""A closed gas chamber that the rod compresses: p Vⁿ constant."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage

Grid = Float[np.ndarray, "loop phase"]


def chamber_force(
    displacement: Grid, pressure: float, volume: float, area: float, exponent: Grid | float
) -> Grid:
    """P A ((V / (V − A x))ⁿ − 1), the gas force above its charge, [L, P] N.

    Args:
        displacement: Of the rod into the chamber, [L, P] m.
        pressure: P, absolute, at x = 0, Pa.
        volume: V at x = 0, m³.
        area: A of the rod, m².
        exponent: n, 1 isothermal, 1.4 adiabatic; or [L, 1].
    """
    share = np.minimum(area * displacement / volume, 0.98)
    return pressure * area * np.expm1(-exponent * np.log1p(-share))


@dataclass(frozen=True, kw_only=True)
class LargeGasChamber(Planter):
    """An accumulator so large that the widest stroke changes its volume by 2 % only.

    Attributes:
        size: Charge, absolute, Pa.
        rod_area: m².
        exponent: n.
    """

    name: ClassVar[str] = "large_gas_chamber"
    causes: ClassVar[tuple[str, ...]] = ("gas_spring",)
    family: ClassVar[str | None] = "reactive"
    stage: ClassVar[Stage] = "force"
    size: float = 4.0e6
    rod_area: float = 5.0e-4
    exponent: float = 1.4

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        volume = self.rod_area * state.widest / 0.02
        gas = chamber_force(state.displacement, self.size, volume, self.rod_area, self.exponent)
        return state.adding(gas)


@dataclass(frozen=True, kw_only=True)
class BalancedGasChamber(Planter):
    """A small chamber whose stiffness about the centre a helper spring takes away.

    Attributes:
        size: Charge, absolute, Pa.
        rod_area: m².
        volume: m³.
        exponent: n.
    """

    name: ClassVar[str] = "balanced_gas_chamber"
    causes: ClassVar[tuple[str, ...]] = ("gas_polytropic",)
    family: ClassVar[str | None] = "gas_nonlinear"
    stage: ClassVar[Stage] = "force"
    size: float = 2.0e6
    rod_area: float = 1.0e-4
    volume: float = 2.0e-5
    exponent: float = 1.3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        x = state.displacement
        gas = chamber_force(x, self.size, self.volume, self.rod_area, self.exponent)
        spring = self.exponent * self.size * self.rod_area**2 / self.volume
        return state.adding(gas - spring * x)


@dataclass(frozen=True, kw_only=True)
class GasChamber(Planter):
    """A monotube damper's gas chamber, whole: its spring and the rest.

    Slow strokes are isothermal, fast ones adiabatic: the gas exchanges heat with the wall with a
    time constant.

    Attributes:
        size: Charge, absolute, Pa.
        rod_area: m².
        volume: m³.
        heat_time: Time constant of the heat exchange, s.
    """

    name: ClassVar[str] = "gas_chamber"
    causes: ClassVar[tuple[str, ...]] = ("gas_spring", "gas_polytropic")
    family: ClassVar[str | None] = "reactive"
    stage: ClassVar[Stage] = "force"
    size: float = 2.0e6
    rod_area: float = 1.0e-4
    volume: float = 2.0e-5
    heat_time: float = 0.5

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        speed = (2.0 * np.pi * state.frequency[:, None] * self.heat_time) ** 2
        n = 1.0 + 0.4 * speed / (1.0 + speed)
        gas = chamber_force(state.displacement, self.size, self.volume, self.rod_area, n)
        return state.adding(gas)
