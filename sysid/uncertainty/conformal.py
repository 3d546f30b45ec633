r"""Conformal bands: how wide a loop's band must be, from loops that a model has not seen.

No likelihood is believed here, and no covariance.  Each test l is predicted without its condition
c(l), and its score is the largest error of the loop, in parts of what is usual at such a force,

    s_l = max_φ |F_l − F̂_{−c,l}| / σ(F̂_{−c,l}),    σ(F)² = σ_0² + (ε RMS F)²

F_l without a static force of the test where the model leaves that free, for F̂ has none;
σ_0 the noise of a point of a loop, ε the median of all tests' relative errors: a test of small
force would else make every band wide.  Whatever σ is, it changes how wide bands are, not what they
promise.

A new test's band is made of what every such model says of it, each widened by its own scores: with
weights 1/(N_c (C + 1)) on the N_c tests of each of C conditions and 1/(C + 1) at infinity, it lies
between the α-quantile of F̂_{−c} − s_l σ(F̂_{−c}) and the (1 − α)-quantile of F̂_{−c} + s_l σ(F̂_{−c}).

What this promises: if the new test's condition and those of the campaign could be exchanged with
one another (drawn alike, in no order), the whole loop lies inside the band with probability 1 − 2α
at least, whatever model and noise are like, and about 1 − α where leaving a condition out hardly
moves the model.  A test matrix is a grid and not drawn, so this holds for conditions among those of
the campaign, not beyond.  It is for any one new test, not for all tests together.  What is left of
likelihood in it: the weights of the fits, and the sizes of Σ, which are those of all tests.

With C < 1/α − 1 conditions the quantile is at infinity and no band of that level exists.

Source:
    Lee, Barber and Willett, "Distribution-free inference with hierarchical data", arXiv 2306.06342
    (2023): hierarchical jackknife+; Barber, Candès, Ramdas and Tibshirani, Annals of Statistics 49
    (2021): jackknife+.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from sysid.models.coordinates import AbstractCoordinates
from sysid.motion.motion import Motion
from sysid.uncertainty.bands import Band
from sysid.uncertainty.covariance import LEVEL
from sysid.uncertainty.force_draws import batch_of, blocks_of, force_draws, some_of
from sysid.uncertainty.left_out import LeftOut


@dataclass(frozen=True)
class Conformal:
    """Scores of a campaign, ready to give bands.

    Attributes:
        level: 1 − α.
        condition: [L] number of each test's condition, from 0.
        scores: [L].
        u: [C, n] parameters fitted without each condition.
        noise: σ_0, N.
        relative: ε.
        words: What is promised, or why nothing is, a sentence.
    """

    level: float
    condition: Int[np.ndarray, " loop"]
    scores: Float[np.ndarray, " loop"]
    u: Float[np.ndarray, "condition n"]
    noise: float
    relative: float
    words: str

    @property
    def possible(self) -> bool:
        """There are conditions enough for a band of this level."""
        return len(self.u) >= conditions_needed(self.level)

    @property
    def score(self) -> float | None:
        """The quantile of the scores: half the band's width, in σ(F), if all models agreed."""
        if not self.possible:
            return None
        return float(upper_quantile(self.scores, weights_of(self.condition), self.level))

    def band(self, coordinates: AbstractCoordinates[Any], motion: Motion) -> Band | None:
        """Of steady cycles; None where there are too few conditions.

        Args:
            coordinates: Map from u to the model.
            motion: [L, P].
        """
        if not self.possible:
            return None
        motion = batch_of(motion)
        found = []
        for some in blocks_of(motion):
            force = force_draws(coordinates, self.u, some_of(motion, some))
            usual = _usual(force, self.noise, self.relative)
            reach = usual[self.condition] * self.scores[:, None]
            low, high = jackknife_plus(force, reach, self.condition, self.level)
            found.append((low, np.median(force, axis=0), high))
        low, middle, high = (np.concatenate(z) for z in zip(*found, strict=True))
        return Band(self.level, middle, low, high)


def conformal(left_out: LeftOut, level: float = LEVEL) -> Conformal:
    """Score the tests of a campaign.

    Args:
        left_out: Each predicted without its condition.
        level: 1 − α.
    """
    error = left_out.measured - left_out.predicted
    relative = float(np.median(_rms(error) / _rms(left_out.predicted)))
    usual = _usual(left_out.predicted, left_out.noise, relative)
    count, needed = len(left_out.u), conditions_needed(level)
    alpha = 1.0 - level
    if count < needed:
        words = (
            f"{count} conditions (amplitude, frequency) are too few for a conformal band of "
            f"{level:g}: it takes {needed}"
        )
    else:
        words = (
            f"a whole loop at a new condition that could be exchanged with the {count} of the "
            f"campaign lies inside with probability {1.0 - 2.0 * alpha:.3g} at least, and about "
            f"{level:g} where one condition hardly moves the model"
        )
    scores = np.abs(error).max(axis=1) / usual
    return Conformal(level, left_out.condition, scores, left_out.u, left_out.noise, relative, words)


def _rms(force: np.ndarray) -> np.ndarray:
    return np.sqrt(np.mean(force**2, axis=-1))


def _usual(force: np.ndarray, noise: float, relative: float) -> np.ndarray:
    """σ(F), N."""
    return np.hypot(noise, relative * _rms(force))


def conditions_needed(level: float) -> int:
    """Conditions without which no band of a level can be promised."""
    return math.ceil(1.0 / (1.0 - level) - 1.0 - 1e-9)


def weights_of(condition: Int[np.ndarray, " loop"]) -> Float[np.ndarray, " loop"]:
    """1/(N_c (C + 1)) of each test; what they lack to one is at infinity."""
    count = np.bincount(condition)
    return 1.0 / count[condition] / (count.size + 1.0)


def jackknife_plus(
    predicted: Float[np.ndarray, "condition *point"],
    reach: Float[np.ndarray, "loop *some"],
    condition: Int[np.ndarray, " loop"],
    level: float,
) -> tuple[Float[np.ndarray, "*point"], Float[np.ndarray, "*point"]]:
    """Ends of a band.

    Args:
        predicted: [C, ...] what each model says of the new tests.
        reach: [L, ...] errors of the campaign's tests, as large as they would be there; broadcast
            over the last axes of `predicted`.
        condition: [L] of these tests.
        level: 1 − α.
    """
    own = predicted[condition]
    reach = reach.reshape(reach.shape + (1,) * (own.ndim - reach.ndim))
    weights = weights_of(condition)
    high = upper_quantile(own + reach, weights, level)
    return -upper_quantile(reach - own, weights, level), high


def upper_quantile(
    values: Float[np.ndarray, "loop *point"], weights: Float[np.ndarray, " loop"], level: float
) -> Float[np.ndarray, "*point"]:
    """The smallest value that at least `level` of the weight does not exceed.

    The weight that is missing to one lies at infinity.
    """
    order = np.argsort(values, axis=0)
    reached = np.cumsum(weights[order], axis=0) >= level - 1e-12
    place = np.argmax(reached, axis=0)[None]
    found = np.take_along_axis(np.take_along_axis(values, order, axis=0), place, axis=0)[0]
    return np.where(reached.any(axis=0), found, np.inf)
