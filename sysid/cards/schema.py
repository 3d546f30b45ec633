"""What a card is made of.  Unknown keys are refused; numbers are finite; everything is SI.

Units are part of the keys, so that nobody has to guess them.  Temperatures are in °C.  Nothing in
here needs more than pydantic, so that a reader without JAX can use it.
"""

import math
from itertools import pairwise
from typing import Annotated, Any, Final, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

SCHEMA: Final = "sysid-card-1"
"""Version of the card's format that this package writes."""

KEYS: Final = {
    "format": "schema",
    "time": "time_s",
    "amplitude": "amplitude_m",
    "displacement": "displacement_m",
    "centre": "centre_m",
    "velocity": "velocity_m/s",
    "acceleration": "acceleration_m/s2",
    "frequency": "frequency_Hz",
    "current": "current_A",
    "temperature": "temperature_degC",
    "force": "force_N",
}
"""Attribute → key in the file, where they differ."""

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0.0)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0)]
Whole = Annotated[int, Field(strict=True)]
Text = Annotated[str, Field(min_length=1)]
Series = tuple[Number, ...]

LARGEST_TOLERANCE: Final = 1e-3
"""Of check vectors: one that is larger proves nothing."""
FEWEST_SAMPLES: Final = 7
"""Of a check vector: fewer are no motion."""


class _Part(BaseModel):
    """A frozen part of a card that knows only its own keys."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        validate_by_name=True,
        alias_generator=lambda name: KEYS.get(name, name),
    )


class Parameter(_Part):
    """A parameter's value with its uncertainty.

    Attributes:
        symbol: The paper's symbol; with the effect's id in front for effects.
        name: In words.
        value: In `unit`.
        unit: SI symbol; "-" for a pure number.
        sd: Standard deviation; 0, with low = high = value, where the variant holds it fixed.
        low: Lower end of the interval that the card's `interval` names; null where unbounded.
        high: Upper end.
        identified: The data determine it.
    """

    symbol: Text
    name: str = ""
    value: Number
    unit: Text
    sd: NotNegative | None
    low: Number | None
    high: Number | None
    identified: Annotated[bool, Field(strict=True)]

    @model_validator(mode="after")
    def _ordered(self) -> "Parameter":
        if self.low is not None and self.high is not None and self.low > self.high:
            raise ValueError(f"low = {self.low:g} is above high = {self.high:g}")
        return self


class Effect(_Part):
    """An effect on the signal path with its parameters.

    Attributes:
        id: Public name.
        stage: Its place on the signal path.
        choice: Which form of the effect, e.g. ``{"side": 1}``; not written where there is one only.
        parameters: All of them; the effect's id stands before each symbol.
    """

    id: Text
    stage: Literal["drive", "motion", "law", "force", "channel"]
    choice: dict[str, Whole | Text] = Field(default_factory=dict)
    parameters: tuple[Parameter, ...]

    @model_serializer(mode="wrap")
    def _without_empty_choice(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written = write(self)
        return {key: z for key, z in written.items() if key != "choice" or z}


class Covariance(_Part):
    """Covariance of the free parameters, in their units."""

    symbols: tuple[Text, ...]
    matrix: tuple[Series, ...]

    @model_validator(mode="after")
    def _square_and_symmetric(self) -> "Covariance":
        n = len(self.symbols)
        if len(set(self.symbols)) != n:
            raise ValueError("a symbol stands there twice")
        if len(self.matrix) != n or any(len(row) != n for row in self.matrix):
            size = f"{len(self.matrix)} × {max(map(len, self.matrix), default=0)}"
            raise ValueError(f"the matrix is {size}, {n} symbols need {n} × {n}")
        for i in range(n):
            if self.matrix[i][i] < 0.0:
                raise ValueError(f"the variance of {self.symbols[i]} is negative")
            for j in range(i):
                one, other = self.matrix[i][j], self.matrix[j][i]
                if abs(one - other) > 1e-9 * math.sqrt(self.matrix[i][i] * self.matrix[j][j]):
                    names = f"{self.symbols[i]}, {self.symbols[j]}"
                    raise ValueError(f"not symmetric at ({names}): {one:g} and {other:g}")
        return self


class Drawn(_Part):
    """What the draws say of one parameter.

    Attributes:
        symbol: Of a parameter of the card.
        median: In the parameter's unit.
        sd: Standard deviation.
        low: Lower end of the interval that the posterior's `interval` names.
        high: Upper end.
        identified: The data determine it.
        rhat: Rank-normalised split-R̂ between ensembles; null where there are too few steps.
        ess_bulk: Effective sample size of the middle of the distribution.
        ess_tail: Of its tails.
    """

    symbol: Text
    median: Number
    sd: NotNegative
    low: Number
    high: Number
    identified: Annotated[bool, Field(strict=True)]
    rhat: Number | None
    ess_bulk: Number | None
    ess_tail: Number | None


class Posterior(_Part):
    """Summary of draws from the posterior of the free parameters.

    Attributes:
        file: With the draws, beside the card (HDF5); null where it was not kept.
        likelihood: Its kind.
        assumed: What it assumes, a sentence.
        prior: One line a parameter.
        interval: What the intervals are.
        ensembles: Independent ones.
        draws: Of all ensembles together.
        converged: The rule of convergence holds for every parameter.
        message: How sampling ended; where it has not converged, what is missing.
        parameters: The free ones.
    """

    file: Text | None
    likelihood: Literal["full", "random_effects", "independent", "power"]
    assumed: Text
    prior: tuple[Text, ...]
    interval: Text
    ensembles: Annotated[int, Field(strict=True, ge=1)]
    draws: Annotated[int, Field(strict=True, ge=1)]
    converged: Annotated[bool, Field(strict=True)]
    message: Text
    parameters: tuple[Drawn, ...] = Field(min_length=1)


Pair = tuple[Number, Number]


class Validity(_Part):
    """The box of conditions that the model was identified in; null where it is not known.

    Attributes:
        amplitude: m, of the displacement's fundamental.
        frequency: Hz; null where no test was sinusoidal.
        velocity: m/s, peak; from 0, since every loop passes through rest.
        current: A.
        temperature: °C.
        centre: m, median over the tests of the mean displacement on the rig, compression positive
            whatever the sign of its files; the model's displacement is relative to it.
    """

    amplitude: Pair
    frequency: Pair | None = Field(
        validation_alias="frequency_Hz", serialization_alias="frequency_Hz"
    )
    velocity: Pair
    current: Pair
    temperature: Pair | None = Field(
        validation_alias="temperature_degC", serialization_alias="temperature_degC"
    )
    centre: Number

    @model_validator(mode="after")
    def _ordered(self) -> "Validity":
        for name in type(self).model_fields:
            pair = getattr(self, name)
            if isinstance(pair, tuple) and pair[0] > pair[1]:
                raise ValueError(f"{KEYS[name]}: {pair[0]:g} is above {pair[1]:g}")
        for name in ("amplitude", "frequency", "velocity"):
            pair = getattr(self, name)
            if isinstance(pair, tuple) and (pair[0] < 0.0 or pair[1] <= 0.0):
                raise ValueError(f"{KEYS[name]}: {pair[0]:g} to {pair[1]:g} holds no motion")
        return self


class Quality(_Part):
    """Errors over the steady loops in free run, RMSE / max|F|, mean over tests.

    Attributes:
        mean_nrmse: Of the fitted tests.
        held_out_mean_nrmse: Of the held-out ones; null without any.
        noise_floor_nrmse: Repeatability: scatter of a single cycle; null where no test has two.
        mean_cycle_noise_nrmse: That over the root of the number of cycles, which is what a perfect
            model would err by; null as above, and in cards of before this key.
    """

    mean_nrmse: NotNegative
    held_out_mean_nrmse: NotNegative | None
    noise_floor_nrmse: NotNegative | None
    mean_cycle_noise_nrmse: NotNegative | None = None


class Damper(_Part):
    """Which damper, and which campaign it was identified from."""

    name: Text
    campaign: Text


class DataFile(_Part):
    """A measured file that the model was identified from."""

    file: Text
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class Check(_Part):
    """A short motion with the force that the model must give, to be recomputed by every reader.

    sgn ẍ is the sign of the acceleration written here, and v_m = √max(v² − ẍ x, 0) point by point
    (W11 Eq. 10), so that nothing but these numbers is needed.

    Attributes:
        time: [n] s.
        displacement: [n] m, relative to the centre.
        velocity: [n] m/s.
        acceleration: [n] m/s².
        current: [n] A.
        temperature: [n] °C; empty where the model was identified without temperatures.
        force: [n] N.
        tolerance: Largest |error| / max|force|.
    """

    time: Series
    displacement: Series = Field(
        validation_alias="displacement_m", serialization_alias="displacement_m"
    )
    velocity: Series
    acceleration: Series = Field(
        validation_alias="acceleration_m/s2", serialization_alias="acceleration_m/s2"
    )
    current: Series
    temperature: Series = Field(
        validation_alias="temperature_degC", serialization_alias="temperature_degC"
    )
    force: Series
    tolerance: Annotated[Positive, Field(le=LARGEST_TOLERANCE)]

    @model_validator(mode="after")
    def _same_length(self) -> "Check":
        n = len(self.time)
        if n < FEWEST_SAMPLES:
            raise ValueError(f"time_s has {n} entries, at least {FEWEST_SAMPLES} are needed")
        if any(later <= earlier for earlier, later in pairwise(self.time)):
            raise ValueError("time_s does not increase from entry to entry")
        for name in type(self).model_fields:
            series = getattr(self, name)
            if not isinstance(series, tuple) or (name == "temperature" and not series):
                continue
            if len(series) != n:
                raise ValueError(f"{KEYS[name]} has {len(series)} entries, time_s has {n}")
        return self


class Card(_Part):
    """An identified model, complete: what to compute, how sure, where valid, and proof vectors."""

    format: Literal["sysid-card-1"]
    software: Text
    model: Text
    variant: Text
    weights: Literal["paper", "peak", "noise"]
    damper: Damper
    parameters: tuple[Parameter, ...] = Field(min_length=1)
    effects: tuple[Effect, ...]
    covariance: Covariance
    posterior: Posterior | None
    interval: Text
    validity: Validity
    quality: Quality
    known_discrepancies: tuple[Text, ...]
    data: tuple[DataFile, ...]
    check: tuple[Check, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _one_name_each(self) -> "Card":
        symbols = [p.symbol for p in self.parameters]
        symbols += [p.symbol for effect in self.effects for p in effect.parameters]
        for symbol in symbols:
            if symbols.count(symbol) > 1:
                raise ValueError(f"parameter {symbol} stands there twice")
        for symbol in self.covariance.symbols:
            if symbol not in symbols:
                raise ValueError(f"covariance names {symbol}, which is no parameter of this card")
        for drawn in () if self.posterior is None else self.posterior.parameters:
            if drawn.symbol not in symbols:
                raise ValueError(
                    f"posterior names {drawn.symbol}, which is no parameter of this card"
                )
        return self

    def values(self) -> dict[str, float]:
        """Symbol → value of the model's parameters."""
        return {p.symbol: p.value for p in self.parameters}


def json_schema() -> dict[str, Any]:
    """The published JSON Schema of a card, as `card-1.schema.json` beside this module holds it."""
    body = Card.model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA, **body}
