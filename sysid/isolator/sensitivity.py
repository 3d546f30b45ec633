"""Which parameter of the damper makes its isolator sensitive to temperature."""

from typing import Final

import equinox as eqx
import jax.numpy as jnp

from sysid.isolator.compare import Change, change
from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.from_card import CardDamper
from sysid.isolator.study import ConflictDiagram
from sysid.models.lumped import Warmth

LAWS: Final = ("C_post", "F_y", "k")
ON: Final = "F_y without 0 A"
CASES: Final = ("cold", *LAWS, ON, "all")
"""Variants of a damper: cold, one law warm in turn, F_y warm but not at 0 A, all warm."""


def one_law_at_a_time(damper: CardDamper, cold: float, warm: float) -> list[AbstractDamperStep]:
    """A damper of the lumped model in each of `CASES`; effects beside it are warm in "all" only.

    Args:
        damper: The damper.
        cold: °C.
        warm: °C.

    Source:
        BS09 Fig. 12, where F_y is called τ_y.  F_y rises with temperature at 0 A and falls at all
        other currents of the paper's table, so the two are also told apart.
    """
    valve = damper.lumped
    assert valve is not None
    at = {
        case: Warmth(*(jnp.asarray(warm if case in (law, "all") else cold) for law in LAWS))
        for case in CASES
        if case != ON
    }
    held = valve.F_y_intercept[0] + valve.F_y_slope[0] * cold
    idle = eqx.tree_at(
        lambda v: (v.F_y_intercept, v.F_y_slope),
        valve,
        (valve.F_y_intercept.at[0].set(held), valve.F_y_slope.at[0].set(0.0)),
    )
    found = []
    for case in CASES:
        model, warmth = (idle, at["F_y"]) if case == ON else (valve, at[case])
        found.append(damper.step_at(model, warm if case == "all" else cold, warmth))
    return found


def changes_by_law(diagram: ConflictDiagram) -> dict[str, tuple[Change, ...]]:
    """Case → change of each controller, at its first set point, from the cold damper.

    Args:
        diagram: Whose variants begin with `CASES`.
    """
    return {
        case: tuple(change(c, c.set_points[0], 0, k) for c in diagram.curves)
        for k, case in enumerate(CASES)
        if k
    }
