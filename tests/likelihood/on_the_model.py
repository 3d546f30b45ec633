"""Tests on the generalised model itself, in few harmonics, that errors are added to."""

from typing import Final

import numpy as np

from sysid.likelihood.discrepancy import Sizes
from sysid.likelihood.observed import Observed, observe
from sysid.models.coordinates import Reference
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign

COORDINATES: Final = GeneralizedCoordinates(
    Reference(force=1000.0, speed=0.4, current=0.4, length=0.025), "symmetric"
)
U: Final = np.asarray(COORDINATES.locate(build(Generalized, LOW_SYMMETRIC)))
RIG: Final = Sizes(gain=6e-3, offset=2.0, delay=1e-4, odd=1e-4, even=1e-4)


def on_the_model(seed: int) -> Observed:
    """66 tests, beside the model that they are of."""
    loops = make_trial(seed, design=TrialDesign(fewest=66, most=66)).loops
    plain = observe(loops, points=72, harmonics=8)
    return plain.beside(Damper(build(Generalized, LOW_SYMMETRIC)), np.zeros_like(plain.measured))
