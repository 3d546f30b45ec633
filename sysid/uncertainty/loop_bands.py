"""All bands of a campaign's tests, those held out included, beside what was measured."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Bool, Float

from sysid.data.loops import Loops
from sysid.identification.result import Fit
from sysid.likelihood.observed import observe
from sysid.uncertainty.bands import DRAWS, Band, Error, predict
from sysid.uncertainty.conformal import Conformal, conformal
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.left_out import leave_conditions_out, static_force
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.quantities import QUANTITIES
from sysid.uncertainty.sample import points_for
from sysid.uncertainty.target import motion_of

KINDS: Final[tuple[Error, ...]] = ("parameters", "laws", "recorded")

LOOPS: Final = 200_000
"""Simulated loops at most, so that a large campaign finds room in memory: tests times draws."""
FEWEST: Final = 100


@dataclass(frozen=True)
class LoopBands:
    """Bands of L tests.

    Attributes:
        ids: [L].
        held_out: [L] not fitted.
        velocity: [L, P] m/s, on the points of the bands.
        measured: [L, P] N, without a static force of the test where the model leaves that free.
        forces: Kind of error → band of the force, [L, P] N; none of what is not known.
        quantities: Of each of `QUANTITIES` the band of the damper's own, [L]: with errors of laws
            where these are known.
        unknown: Kind of error → why it is not known.
        outside: [L] in what each test leaves the ranges of those fitted, "" where in nothing.
        conformal: Scores of tests left out.
        conformal_band: [L, P] N; None where conditions are too few.
        draws: Of the parameters.
        statics_free: A static force of each test was taken out of `measured`.
    """

    ids: tuple[str, ...]
    held_out: Bool[np.ndarray, " loop"]
    velocity: Float[np.ndarray, "loop point"]
    measured: Float[np.ndarray, "loop point"]
    forces: Mapping[Error, Band]
    quantities: tuple[Band, ...]
    unknown: Mapping[Error, str]
    outside: tuple[str, ...]
    conformal: Conformal
    conformal_band: Band | None
    draws: int
    statics_free: bool = False

    def half_width(self, band: Band) -> Float[np.ndarray, " loop"]:
        """[L] N, mean over the loop."""
        return np.mean(band.high - band.low, axis=1) / 2.0

    @property
    def inside(self) -> Float[np.ndarray, " loop"]:
        """[L] share of each loop's measured points within the band of what would be recorded."""
        return np.mean(self.forces["recorded"].holds(self.measured), axis=1)

    @property
    def whole_inside(self) -> Bool[np.ndarray, " loop"] | None:
        """[L] the whole measured loop lies in the conformal band."""
        if self.conformal_band is None:
            return None
        return np.all(self.conformal_band.holds(self.measured), axis=1)


def loop_bands(
    fit: Fit,
    loops: Loops,
    held_out: Bool[np.ndarray, " loop"],
    posterior: Posterior,
    errors: ErrorModel,
    seed: int = 0,
) -> LoopBands:
    """Make all bands of some tests.

    Args:
        fit: The fit.
        loops: Tests that were fitted, and others.
        held_out: [L] which were not.
        posterior: Of the fit.
        errors: Its likelihood.
        seed: Of errors of laws and rig.
    """
    seen = observe(loops, points=points_for(fit.model, loops))
    motion = motion_of(seen)
    draws = int(np.clip(LOOPS / len(loops.ids), FEWEST, DRAWS))
    prediction = predict(posterior, fit.coordinates, motion, errors=errors, draws=draws, seed=seed)
    kinds: list[Error] = [kind for kind in KINDS if kind not in prediction.unknown]
    forces, quantities = prediction.bands(kinds, QUANTITIES)
    measured = seen.force
    if fit.coordinates.statics_free:
        measured = measured - static_force(measured, forces["parameters"].middle)
    scores = conformal(leave_conditions_out(errors, fit.coordinates))
    return LoopBands(
        ids=loops.ids,
        held_out=held_out,
        velocity=np.asarray(motion.velocity),
        measured=measured,
        statics_free=fit.coordinates.statics_free,
        forces=forces,
        quantities=tuple(quantities["laws" if "laws" in kinds else "parameters"]),
        unknown=prediction.unknown,
        outside=prediction.outside,
        conformal=scores,
        conformal_band=scores.band(fit.coordinates, motion),
        draws=len(prediction.u),
    )
