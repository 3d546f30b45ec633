"""Structural misfit by its definition: what the refitted base leaves of a perfect measurement."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.errors import DataError
from sysid.identification.fit import fit_loops
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign

BASE: Final = "symmetric"
"""Variant of the generalised model that the damper of a trial belongs to."""
START: Final = {2.0: 0.038, 5.0: 0.095}
"""Misfit, % → ε that gives about that much in a typical campaign."""
CLOSE: Final = 0.03
"""Relative error of the misfit that is small enough."""
_ROUNDS: Final = 8


@dataclass(frozen=True)
class Misfit:
    """How far a damper departs from the laws of the base model.

    Attributes:
        size: ε of `law_factors`.
        percent: RMS that the refitted base leaves, % of the RMS force.
        left: [L, J] N, what it leaves, without errors of the rig.
    """

    size: float
    percent: float
    left: Float[np.ndarray, "loop phase"]


def refitted_misfit(seed: int, size: float, design: TrialDesign) -> Misfit:
    """What the base leaves of a campaign without effects, noise and errors of the rig.

    Args:
        seed: Of the campaign.
        size: ε.
        design: Of the campaign; tests, motions and damper follow from it.
    """
    perfect = replace(design, misfit=size, noise=0.0, relative_noise=0.0, gain_sd=0.0,
                      offset_sd=0.0, delay_sd=0.0)  # fmt: skip
    loops = make_trial(seed, design=perfect).loops
    fit = fit_loops(loops, variant=BASE)
    left = loops.force - np.asarray(simulate(fit.valve, loop_motion(loops)))
    share = float(np.sqrt(np.mean(left**2) / np.mean(loops.force**2)))
    return Misfit(size, 100.0 * share, left)


def misfit_of(seed: int, percent: float, design: TrialDesign) -> Misfit:
    """The misfit of a wanted size in one campaign; its random laws follow from the seed.

    Args:
        seed: Of the campaign.
        percent: RMS that the refitted base shall leave, % of the RMS force; 0 for none.
        design: Of the campaign.

    Raises:
        DataError: No ε gives it.
    """
    if percent == 0.0:
        return Misfit(0.0, 0.0, np.zeros((1, 1)))
    size = START.get(percent, 0.019 * percent)
    for _ in range(_ROUNDS):
        found = refitted_misfit(seed, size, design)
        if abs(np.log(found.percent / percent)) < CLOSE:
            return found
        size *= float(np.clip(percent / found.percent, 0.25, 4.0))
    raise DataError(
        f"no departure from the laws leaves {percent:g} % in campaign {seed}",
        advice="Choose a smaller misfit, or another seed",
    )
