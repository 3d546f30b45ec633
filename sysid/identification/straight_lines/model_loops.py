"""The recipes applied to loops of a model, whose parameters are known."""

from dataclasses import replace

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.straight_lines.bias import Bias
from sysid.identification.straight_lines.recipes import StraightLines
from sysid.identification.straight_lines.stage import Reading


def with_force(loops: Loops, force: np.ndarray) -> Loops:
    """The same motion with a simulated force, [L, J] N: one cycle each, free of noise."""
    points = force.shape[1]
    still = tuple(np.zeros((1, points)) for _ in loops.ids)
    return replace(
        loops,
        force=force,
        cycles=np.ones(len(loops.ids), dtype=np.int64),
        noise_floor=np.zeros(len(loops.ids)),
        deviations=still,
        displacement_deviations=still,
        start_phase=None,
    )


def recipe_bias(
    found: StraightLines, viscosity: np.ndarray, yield_force: np.ndarray, stiffness: np.ndarray
) -> Bias:
    """Bias of recipes that were applied to loops of a model.

    Args:
        found: What the recipes gave on those loops.
        viscosity: [L] N·s/m, C_post that the model has at each test's current and temperature.
        yield_force: [L] N, F_y.
        stiffness: [L] N/m, k.
    """

    def of(readings: tuple[Reading, ...], truth: np.ndarray) -> dict[str, float]:
        return {r.id: r.value / float(truth[r.test]) - 1.0 for r in readings}

    return Bias(
        of(found.viscosity.readings, viscosity),
        of(found.yield_force.readings, yield_force),
        of(found.stiffness.readings, stiffness),
    )
