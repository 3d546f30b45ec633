"""Effects outside the catalogue: the cylinder wall and the magnet along the stroke."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.lugre import lugre_force
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class ScratchedWall(Planter):
    """A scratch in the cylinder at one place: the seal chatters over it.

    Attributes:
        size: Friction on the scratch, N.
        place: m.
        width: m.
        pitch: Of the chatter marks, m.
        stiffness: Of the seal, N/m.
    """

    name: ClassVar[str] = "scratched_wall"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "friction"
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 80.0
    place: float = 1.0e-3
    width: float = 2.0e-3
    pitch: float = 1.5e-3
    stiffness: float = 1.0e6

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        aside = state.displacement - self.place
        marks = 0.5 * (1.0 + np.cos(2.0 * np.pi * aside / self.pitch))
        slip = self.size * np.exp(-0.5 * (aside / self.width) ** 2) * marks
        return state.adding(lugre_force(state, slip, self.stiffness))


@dataclass(frozen=True, kw_only=True)
class FadingMagnet(Planter):
    """The flux path saturates where the piston leaves the thick middle of the tube.

    Attributes:
        size: Share of the field's force lost at the widest stroke.
    """

    name: ClassVar[str] = "fading_magnet"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "current_law"
    stage: ClassVar[Stage] = "force"
    size: float = 0.15

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        out = (state.displacement / state.widest) ** 2
        return state.adding(-self.size * out * state.field_part())
