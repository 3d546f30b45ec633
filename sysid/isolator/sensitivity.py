"""Which parameter of the damper makes its isolator sensitive to temperature."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import jax.numpy as jnp

from sysid.isolator.base_motion import BaseMotion
from sysid.isolator.closed_loop import CLOCK, Clock
from sysid.isolator.compare import Change, change
from sysid.isolator.families import Family
from sysid.isolator.lumped_step import LumpedStep, lumped_step_at
from sysid.isolator.plant import Plant
from sysid.isolator.study import conflict_diagram, stacked
from sysid.models.lumped import Lumped

LAWS: Final = ("C_post", "F_y", "k")


@dataclass(frozen=True)
class Sensitivity:
    """Changes from a cold damper to one with one law warm, or all.

    Attributes:
        cold: °C.
        warm: °C.
        changes: Law, or "all" → one change a controller.
    """

    cold: float
    warm: float
    changes: dict[str, tuple[Change, ...]]


def one_law_at_a_time(valve: Lumped, cold: float, warm: float) -> LumpedStep:
    """The cold damper, then C_post, F_y and k warm in turn, then all of them."""
    at = [
        [warm if which in (law, "all") else cold for law in LAWS]
        for which in ("none", *LAWS, "all")
    ]
    return stacked([lumped_step_at(valve, *(jnp.asarray(z) for z in row)) for row in at])


def sensitivity(
    plant: Plant,
    families: Sequence[Family],
    valve: Lumped,
    base: BaseMotion,
    cold: float,
    warm: float,
    clock: Clock = CLOCK,
) -> Sensitivity:
    """Each temperature-sensitive parameter varied in turn, all others held cold.

    Args:
        plant: The plant.
        families: Controllers, each with one set point.
        valve: The damper.
        base: Motions.
        cold: °C.
        warm: °C.
        clock: Time steps.

    Source:
        BS09 Fig. 12, where F_y is called τ_y.
    """
    names = ("cold", *LAWS, "all")
    found = conflict_diagram(
        plant, families, one_law_at_a_time(valve, cold, warm), names, base, clock
    )
    changes = {
        law: tuple(change(curve, curve.set_points[0], 0, k) for curve in found.curves)
        for k, law in enumerate(names)
        if k
    }
    return Sensitivity(cold, warm, changes)
