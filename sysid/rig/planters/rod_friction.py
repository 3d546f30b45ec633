"""Friction of seals and bushes on the rod, by LuGre's equation in its different regimes."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.lugre import lugre_force
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class StiffSeal(Planter):
    """A hard seal: slips after a few micrometres.

    Attributes:
        size: Friction in sliding, N.
        stiffness: σ_0, N/m.
    """

    name: ClassVar[str] = "stiff_seal"
    causes: ClassVar[tuple[str, ...]] = ("seal_friction",)
    family: ClassVar[str | None] = "friction"
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 30.0
    stiffness: float = 5.0e6

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.adding(lugre_force(state, np.full((1, 1), self.size), self.stiffness))


@dataclass(frozen=True, kw_only=True)
class SoftSeal(Planter):
    """A soft lip seal: it bends a good part of a millimetre before it slips.

    Attributes:
        size: Friction in sliding, N.
        bend: Travel in which the lip takes up its friction, m.
    """

    name: ClassVar[str] = "soft_seal"
    causes: ClassVar[tuple[str, ...]] = ("presliding_friction",)
    family: ClassVar[str | None] = "friction"
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 40.0
    bend: float = 3.0e-4

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        if self.size == 0.0:
            return state
        return state.adding(lugre_force(state, np.full((1, 1), self.size), self.size / self.bend))


@dataclass(frozen=True, kw_only=True)
class BreakawaySeal(Planter):
    """What the friction of a seal at creeping speed exceeds that in fast sliding by.

    Attributes:
        size: Excess at standstill, N.
        film_speed: Speed at which a film of oil carries the lip, m/s.
        stiffness: σ_0, N/m.
    """

    name: ClassVar[str] = "breakaway_seal"
    causes: ClassVar[tuple[str, ...]] = ("stribeck_friction",)
    family: ClassVar[str | None] = "friction"
    stage: ClassVar[Stage] = "force"
    size: float = 40.0
    film_speed: float = 8.0e-3
    stiffness: float = 5.0e6

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        excess = self.size * np.exp(-((state.velocity / self.film_speed) ** 2))
        return state.adding(lugre_force(state, excess, self.stiffness))


@dataclass(frozen=True, kw_only=True)
class SideLoad(Planter):
    """A rod that is pressed against its bush the harder the further it is in.

    The bush carries a preload, so that the rod never leaves it; friction under the preload alone
    is part of the damper.

    Attributes:
        size: Friction per travel, N/m.
        stiffness: σ_0, N/m.
    """

    name: ClassVar[str] = "side_load"
    causes: ClassVar[tuple[str, ...]] = ("position_friction",)
    family: ClassVar[str | None] = "friction"
    stage: ClassVar[Stage] = "force"
    size: float = 600.0
    stiffness: float = 5.0e6

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        preload = 1.2 * abs(self.size) * state.widest
        middle = np.full((1, 1), preload)
        pressed = lugre_force(state, middle + self.size * state.displacement, self.stiffness)
        return state.adding(pressed - lugre_force(state, middle, self.stiffness))
