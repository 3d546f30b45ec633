"""What to do about tests that were all made at one current."""

import numpy as np

from sysid.cli.selection import Selection
from sysid.identification.result import Fit
from sysid.identification.straight_lines.levels import amperes, current_levels

WITHOUT = "passive"
"""Variant of the generalised model that has no laws over current."""


def one_current(fit: Fit, selection: Selection) -> tuple[str, ...]:
    """A sentence where parameters of laws over current were sought in tests of a single one.

    Args:
        fit: The fit.
        selection: Its tests.
    """
    if fit.model != "generalized" or fit.variant == WITHOUT or selection.others:
        return ()
    used = {t.id for t in fit.tests if t.used}
    current = selection.loops.current[np.array([i in used for i in selection.loops.ids])]
    levels = current_levels(current)
    if len(levels) != 1:
        return ()
    return (
        f"All fitted tests have one current, {amperes(levels[0][0])} A, and say nothing of laws "
        f"over current. --variant {WITHOUT} fits what they tell, for this current alone.",
    )
