"""Bands that a force lies in: of loops, of any motion, and of what is read off a force.

Three things may be asked of the same draws of the parameters:

    parameters  the force of the model, were its laws right: its parameters are not known exactly
    laws        the force of the damper: besides, errors of the laws as Σ has them, given the
                campaign's residuals (`law_errors`)
    recorded    what a rig would record of it as the mean of cycles: besides, gain, offset and delay
                of a new test, and noise

At the campaign's own conditions a band with errors of the laws may be narrower than that of the
parameters: residuals tell the force of the damper there better than its parameters.

Errors of laws are known over amplitude, frequency, current and, where forces go by it, temperature
of steady cycles, so they are added to steady cycles only.  Beyond the campaign's ranges they are
extrapolated: the band widens to the prior size of such errors, which a campaign cannot vouch for,
and this is said.  On any other motion nothing is known of them, and a band that asks for them is
refused.

Bands are pointwise: each point lies within its band with the probability of the level, not the
whole loop.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.models.coordinates import AbstractCoordinates
from sysid.motion.motion import Motion
from sysid.uncertainty.covariance import LEVEL
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.force_draws import batch_of, blocks_of, force_draws, some_of
from sysid.uncertainty.law_errors import (
    LoopErrors,
    Steady,
    has_law_errors,
    law_errors,
    rig_errors,
    steady_cycles,
)
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.quantities import Quantity
from sysid.uncertainty.target import harmonics_of

Error = Literal["parameters", "laws", "recorded"]

DRAWS: Final = 1000
"""Of the parameters; the ends of a 95 % band then scatter by a tenth of a standard deviation."""
SLACK: Final = 0.02
"""Actuators do not hit their label: so far beyond the campaign counts as inside."""
WARMER: Final = 2.0
"""K; so far beyond the campaign's temperatures counts as inside: two thermocouples differ by it."""


@dataclass(frozen=True)
class Band:
    """A band, pointwise.

    Attributes:
        level: Probability that the value of a point is inside.
        middle: [..., n] median.
        low: [..., n].
        high: [..., n].
    """

    level: float
    middle: Float[np.ndarray, "..."]
    low: Float[np.ndarray, "..."]
    high: Float[np.ndarray, "..."]

    def holds(self, values: Float[np.ndarray, "..."]) -> np.ndarray:
        """Which values are inside, in their shape."""
        return (values >= self.low) & (values <= self.high)


@dataclass(frozen=True)
class Prediction:
    """Draws of the force on some motions.

    Attributes:
        coordinates: Map from u to the model.
        u: [D, n] draws of the parameters.
        motion: [L, P].
        laws: Errors of the laws, given the campaign's residuals; None where nothing is known.
        rig: Errors of the rig in a new test, and noise; None where nothing is known.
        seed: Of the noise.
        outside: [L] in what each test leaves the campaign's ranges, "" where in nothing.
        unknown: Error → why no band can hold it, a sentence; nothing of what one can.
    """

    coordinates: AbstractCoordinates[Any]
    u: Float[np.ndarray, "draw n"]
    motion: Motion
    laws: LoopErrors | None
    rig: LoopErrors | None
    seed: int
    outside: tuple[str, ...]
    unknown: Mapping[Error, str]

    def forces(
        self, kinds: Sequence[Error] = ("parameters",)
    ) -> Iterator[tuple[Motion, dict[Error, Float[np.ndarray, "draw some point"]]]]:
        """Draws of the force, N, some tests at a time, with each of some kinds of error.

        Args:
            kinds: What the draws are to contain.

        Raises:
            ValueError: One of them is not known here.
        """
        for kind in kinds:
            if kind in self.unknown:
                raise ValueError(self.unknown[kind])
        for number, some in enumerate(blocks_of(self.motion)):
            rng = np.random.default_rng([self.seed, number])
            motion = some_of(self.motion, some)
            force = force_draws(self.coordinates, self.u, motion)
            found: dict[Error, np.ndarray] = {"parameters": force}
            if {"laws", "recorded"} & set(kinds):
                force = force if self.laws is None else force + self.laws.at(some, rng)
                found["laws"] = force
            if "recorded" in kinds and self.rig is not None:
                found["recorded"] = force + self.rig.at(some, rng)
            yield motion, {kind: found[kind] for kind in kinds}

    def band(self, error: Error = "parameters", level: float = LEVEL) -> Band:
        """Of the force at every point, [L, P] N."""
        return self.bands((error,), (), level)[0][error]

    def reading(
        self, quantity: Quantity, error: Error = "parameters", level: float = LEVEL
    ) -> Band:
        """Of what is read off the force of each test, [L]."""
        return self.bands((error,), (quantity,), level)[1][error][0]

    def bands(
        self, kinds: Sequence[Error], quantities: Sequence[Quantity] = (), level: float = LEVEL
    ) -> tuple[dict[Error, Band], dict[Error, list[Band]]]:
        """Of the force, and of quantities, with several kinds of error from the same draws.

        Args:
            kinds: What the bands are to contain.
            quantities: What is read off the force.
            level: Of the bands.

        Returns:
            Bands of the force, [L, P] N, and of each quantity, [L].
        """
        forces: dict[Error, list[Band]] = {kind: [] for kind in kinds}
        read: dict[Error, list[list[Band]]] = {kind: [[] for _ in quantities] for kind in kinds}
        for motion, drawn in self.forces(kinds):
            for kind, force in drawn.items():
                forces[kind].append(_band(force, level))
                for into, quantity in zip(read[kind], quantities, strict=True):
                    into.append(_band(quantity.read(force, motion), level))
        return (
            {kind: _joined(parts) for kind, parts in forces.items()},
            {kind: [_joined(parts) for parts in each] for kind, each in read.items()},
        )


def predict(
    posterior: Posterior,
    coordinates: AbstractCoordinates[Any],
    motion: Motion,
    *,
    errors: ErrorModel | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> Prediction:
    """Predict the force on steady cycles or on any other motion.

    Args:
        posterior: Draws of the parameters.
        coordinates: Of the fit that was drawn from.
        motion: [L, P] of `loop_motion` or `sine_motion`, or [n] of `time_motion`.
        errors: The likelihood of the posterior; needed for more than parameters.
        draws: D at most.
        seed: Of errors and noise.
    """
    u = posterior.coordinates.reshape(-1, posterior.coordinates.shape[2])
    u = u[np.linspace(0, len(u) - 1, min(draws, len(u))).astype(int)]
    return predict_at(u, coordinates, motion, errors=errors, seed=seed)


def predict_at(
    u: Float[np.ndarray, "draw n"],
    coordinates: AbstractCoordinates[Any],
    motion: Motion,
    *,
    errors: ErrorModel | None = None,
    seed: int = 0,
) -> Prediction:
    """The same from draws of the parameters, however they were found.

    Args:
        u: [D, n].
        coordinates: Map from u to the model.
        motion: As for `predict`.
        errors: The likelihood.
        seed: Of errors and noise.
    """
    motion = batch_of(motion)
    unknown = _unknown(errors, motion)
    laws = rig = None
    outside = ("",) * motion.displacement.shape[0]
    if errors is not None and motion.periodic:
        wanted = steady_cycles(motion)
        outside = beyond(errors.observed.loops, wanted)
        rng = np.random.default_rng([seed, len(u)])
        if "laws" not in unknown:
            residual = errors.observed.measured - harmonics_of(coordinates, errors.observed, u)
            laws = law_errors(errors, coordinates, residual, wanted, rng)
        rig = rig_errors(errors, coordinates, wanted, len(u), rng)
    return Prediction(coordinates, u, motion, laws, rig, seed, outside, unknown)


def _unknown(errors: ErrorModel | None, motion: Motion) -> dict[Error, str]:
    """What no band can hold, and why."""
    if errors is None:
        why = "Without a likelihood nothing is known of other errors than those of the parameters"
        return {"laws": why, "recorded": why}
    if not motion.periodic:
        why = (
            "Errors of the laws are known over amplitude, frequency and current of steady cycles; "
            "on any other motion a band holds the errors of the parameters alone"
        )
        return {"laws": why, "recorded": why}
    if not has_law_errors(errors):
        return {
            "laws": f"The {errors.kind.replace('_', ' ')} likelihood takes the model's laws to be "
            "right, so nothing is known of their errors"
        }
    return {}


def beyond(loops: Loops, wanted: Steady) -> tuple[str, ...]:
    """In what each test leaves the campaign's ranges, "" where in nothing.

    Of temperature only those tests tell, and are asked, in which it is known.

    Args:
        loops: The campaign's.
        wanted: Where a force is predicted.
    """
    speed = 2.0 * np.pi * wanted.amplitude * wanted.frequency
    ranges: tuple[tuple[str, np.ndarray, np.ndarray], ...] = (
        ("amplitude", wanted.amplitude, loops.amplitude),
        ("frequency", wanted.frequency, loops.frequency),
        ("speed", speed, loops.peak_velocity),
        ("current", wanted.current, loops.current),
        ("temperature", wanted.temperature, loops.temperature),
    )
    told: list[list[str]] = [[] for _ in speed]
    for name, values, known in ranges:
        known = known[np.isfinite(known)]
        if not known.size:  # no test has a temperature
            continue
        low, high = float(known.min()), float(known.max())
        slack = WARMER if name == "temperature" else SLACK * max(abs(low), abs(high))
        for k in np.flatnonzero((values < low - slack) | (values > high + slack)):
            told[k].append(name)
    return tuple(", ".join(names) for names in told)


def _band(draws: np.ndarray, level: float) -> Band:
    ends = [0.5 - level / 2.0, 0.5, 0.5 + level / 2.0]
    low, middle, high = np.quantile(draws, ends, axis=0)
    return Band(level, middle, low, high)


def _joined(bands: list[Band]) -> Band:
    low, middle, high = (
        np.concatenate([getattr(b, end) for b in bands]) for end in ("low", "middle", "high")
    )
    return Band(bands[0].level, middle, low, high)
