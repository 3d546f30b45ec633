"""The models that `sysid fit` knows: an explicit table, one row a model."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from sysid.data.loops import Loops
from sysid.errors import FitError
from sysid.identification.features import LoopFeatures
from sysid.identification.problem import Problem
from sysid.identification.starts.bouc_wen import bouc_wen_start
from sysid.identification.starts.carreau import carreau_start
from sysid.identification.starts.dahl import dahl_start
from sysid.identification.starts.generalized import generalized_start
from sysid.identification.starts.lumped import lumped_start
from sysid.identification.starts.modified_bouc_wen import modified_bouc_wen_start
from sysid.identification.starts.tanh_kwok import tanh_kwok_start
from sysid.models.base import AbstractValve
from sysid.models.bouc_wen import BoucWen
from sysid.models.bouc_wen_coordinates import BOUC_WEN_VARIANTS, BoucWenCoordinates
from sysid.models.carreau import Carreau
from sysid.models.carreau_coordinates import CARREAU_VARIANTS, CarreauCoordinates
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.dahl import Dahl
from sysid.models.dahl_coordinates import DAHL_VARIANTS, DahlCoordinates
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import VARIANTS, GeneralizedCoordinates
from sysid.models.levels import levels_of
from sysid.models.lumped import Lumped
from sysid.models.lumped_coordinates import LUMPED_VARIANTS, lumped_coordinates
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.models.modified_bouc_wen_coordinates import (
    MODIFIED_BOUC_WEN_VARIANTS,
    ModifiedBoucWenCoordinates,
)
from sysid.models.tanh_kwok import TanhKwok
from sysid.models.tanh_kwok_coordinates import TANH_VARIANTS, TanhKwokCoordinates

NEARLY: Final = 1.05
"""By which a slow test may miss the points that it needs: frequencies of a rig scatter."""
MOST_TIMES: Final = 8
"""Most points of a cycle to simulate on, in multiples of those that the loops have."""
RINGING: Final = 720.0
"""Hz: points a second on which the lumped model's mass is followed as it rings after a reversal,
at up to 402 Hz with BS09's Table 1 (√(k/m_l) at 75 °C).  On as many, what is folded into the lower
harmonics stays below a third of their noise from 0.5 to 8 Hz (tests/likelihood/test_points.py)."""


@dataclass(frozen=True)
class Family:
    """A model that can be fitted.

    Attributes:
        name: As on the command line and in cards.
        valve: Its class.
        variants: Names of its variants, the default first.
        coordinates: (reference, variant) → solver coordinates; for a model with tables
            (reference, levels, variant).
        start: (features of loops, or None where there are none; coordinates) → first start, [n].
        tabled: Its laws are tables over the campaign's own currents.
        points: Of a cycle that tell its lower harmonics: what jumps or rings after a reversal is
            folded into them where there are too few, and passes for something slow.
        rate: Points a second that what rings in it needs, Hz; 0 where nothing does.
    """

    name: str
    valve: type[AbstractValve]
    variants: tuple[str, ...]
    coordinates: Callable[..., AbstractCoordinates]
    start: Callable[[LoopFeatures | None, Any], np.ndarray]
    tabled: bool = False
    points: int = 360
    rate: float = 0.0

    @property
    def memoryless(self) -> bool:
        """Its force at an instant follows from the motion at that instant alone."""
        return self.valve.memoryless

    def points_for(self, loops: Loops) -> int:
        """Points of a cycle to simulate on, for harmonics without what is folded into them.

        A multiple of the loops' own where these are too few for what rings in their slowest test.

        Args:
            loops: L tests on J phase points.

        Returns:
            `points`, or J where that is less; or J, 2 J … for slow tests of what rings.
        """
        own = loops.force.shape[1]
        needed = self.rate / float(loops.frequency.min())
        if needed <= NEARLY * min(self.points, own):
            return min(self.points, own)
        return own * min(math.ceil(needed / (NEARLY * own)), MOST_TIMES)

    def coordinates_for(self, problems: Sequence[Problem], variant: str) -> AbstractCoordinates:
        """Solver coordinates for a campaign.

        Args:
            problems: All that is fitted, with one reference.
            variant: One of `variants`.

        Raises:
            FitError: The campaign does not tell what the model needs.
        """
        reference = problems[0].reference
        if self.tabled:
            return self.coordinates(reference, levels_of([p.motion for p in problems]), variant)
        return self.coordinates(reference, variant)


FAMILIES: Final[tuple[Family, ...]] = (
    Family("generalized", Generalized, VARIANTS, GeneralizedCoordinates, generalized_start),
    Family("tanh", TanhKwok, TANH_VARIANTS, TanhKwokCoordinates, tanh_kwok_start),
    Family("dahl", Dahl, DAHL_VARIANTS, DahlCoordinates, dahl_start),
    Family("bouc_wen", BoucWen, BOUC_WEN_VARIANTS, BoucWenCoordinates, bouc_wen_start),
    Family(
        "modified_bouc_wen",
        ModifiedBoucWen,
        MODIFIED_BOUC_WEN_VARIANTS,
        ModifiedBoucWenCoordinates,
        modified_bouc_wen_start,
        points=180,
    ),
    Family("carreau", Carreau, CARREAU_VARIANTS, CarreauCoordinates, carreau_start),
    Family(
        "lumped",
        Lumped,
        LUMPED_VARIANTS,
        lumped_coordinates,
        lumped_start,
        tabled=True,
        rate=RINGING,
    ),
)


def family(model: str, variant: str | None = None) -> Family:
    """Look a model up.

    Raises:
        FitError: The model, or its variant, is not known.
    """
    for candidate in FAMILIES:
        if candidate.name == model:
            if variant is not None and variant not in candidate.variants:
                raise FitError(
                    f"the {model} model has no variant {variant!r}",
                    advice=f"Its variants: {', '.join(candidate.variants)}",
                )
            return candidate
    raise FitError(
        f"model {model!r} is not known",
        advice=f"Known models: {', '.join(f.name for f in FAMILIES)}",
    )
