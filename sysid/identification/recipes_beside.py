"""The paper's straight lines beside the refined fit, and their bias on its loops."""

from dataclasses import dataclass

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.straight_lines.bias import Bias
from sysid.identification.straight_lines.model_loops import recipe_bias, with_force
from sysid.identification.straight_lines.recipes import (
    StraightLines,
    lines_without,
    straight_line_fits,
)
from sysid.models.lumped import Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion


@dataclass(frozen=True)
class RecipesBeside:
    """Recipes on measured loops, and on those of the fitted model on the same motion.

    Attributes:
        loops: The loops that were read.
        found: What the recipes give.
        bias: Recipe over the fit's parameter minus one, test by test, on the fit's loops.
        unbiased: The lines without that bias, by which it is judged whether laws bend.
    """

    loops: Loops
    found: StraightLines
    bias: Bias
    unbiased: StraightLines

    @property
    def any_line(self) -> bool:
        """There is a line against temperature."""
        found = self.found
        return bool(found.viscosity_lines or found.yield_lines or found.stiffness_lines)


def recipes_beside(valve: Lumped, loops: Loops) -> RecipesBeside:
    """Apply the recipes twice.

    Args:
        valve: The fitted model.
        loops: Loops with known currents.
    """
    motion = loop_motion(loops)
    element = valve.element(motion)
    numbers = (element.post, element.yielding, element.stiffness)
    at_test = [np.broadcast_to(np.asarray(z), (len(loops.ids), 1))[:, 0] for z in numbers]
    own = straight_line_fits(with_force(loops, np.asarray(simulate(valve, motion))))
    found, bias = straight_line_fits(loops), recipe_bias(own, *at_test)
    return RecipesBeside(loops, found, bias, lines_without(found, bias))
