"""What every planter is: physics that hides an effect in virtual tests, with one knob."""

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import ClassVar, Literal

from sysid.rig.planters.bench_state import BenchState

Stage = Literal["drive", "law", "motion", "joint", "force", "channel"]
STAGES: tuple[Stage, ...] = ("drive", "law", "motion", "joint", "force", "channel")
"""The way of the signal; planters of one campaign act in this order.

Up to "motion" a planter changes the valve, its field or its motion; from "joint" on, its force."""


@dataclass(frozen=True, kw_only=True)
class Planter(ABC):
    """Hides one effect.

    The first field of a subclass, `size`, is a physical quantity in SI units: 0 is the bench
    without the effect, its default is realistic.  Other fields describe the same part.

    Attributes:
        name: Of the planter, unique.
        causes: Ids of the effects of the catalogue that it plants; empty for an effect that is
            not in the catalogue.
        family: Of those effects in the catalogue; for an effect outside it the family declared
            before any diagnosis, None where it belongs to none.
        stage: Where on the way of the signal it acts.
        dissipates: It can take energy out of the motion but never give any.
    """

    name: ClassVar[str]
    causes: ClassVar[tuple[str, ...]]
    family: ClassVar[str | None]
    stage: ClassVar[Stage]
    dissipates: ClassVar[bool] = False

    size: float

    @abstractmethod
    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""

    def nominal(self) -> dict[str, float]:
        """Its quantities, SI."""
        return {key: float(value) for key, value in asdict(self).items()}


def plant_all(planters: tuple[Planter, ...], state: BenchState) -> BenchState:
    """Plant several effects, in the order of the signal."""
    for planter in sorted(planters, key=lambda planter: STAGES.index(planter.stage)):
        state = planter.plant(state)
    return state
