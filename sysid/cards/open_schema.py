"""What `open.json` is made of: what a diagnosis left open, for `sysid next`. Everything is SI."""

from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

SCHEMA: Final = "sysid-open-1"

Number = Annotated[float, Field(allow_inf_nan=False)]
Size = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        validate_by_name=True,
        alias_generator=lambda name: "schema" if name == "format" else name,
    )


class OpenEffect(_Part):
    """An effect at its values."""

    id: str
    choice: dict[str, str | int]
    parameters: dict[str, Number]


class OpenAlternative(_Part):
    """One explanation: a damper fitted to all tests.

    Attributes:
        ids: Effects that make it up.
        parameters: Of the model, symbol → value.
        effects: All of them.
        symbols: Of the free parameters, effects as "id.symbol".
        ties: (follower, leader).
        covariance: Of the free parameters; empty where they are taken as known.
    """

    ids: tuple[str, ...]
    parameters: dict[str, Number]
    effects: tuple[OpenEffect, ...]
    symbols: tuple[str, ...]
    ties: tuple[tuple[str, str], ...]
    covariance: tuple[tuple[Number, ...], ...]


class OpenQuestion(_Part):
    """Alternatives by their number."""

    kind: Literal["class", "invisible"]
    about: tuple[str, ...]
    alternatives: Annotated[tuple[int, ...], Field(min_length=2)]


class OpenTold(_Part):
    """Something that no simulated test answers, and the test that would, in words."""

    about: tuple[str, ...]
    test: str


class OpenConditions(_Part):
    """Conditions of the tests that were done, and their largest force; null is unknown."""

    amplitude_m: tuple[Positive, Positive]
    frequency_Hz: tuple[Positive, Positive]
    current_A: Annotated[tuple[Number, ...], Field(min_length=1)]
    temperature_degC: Number | None
    displacement_m: Positive
    speed_m_s: Annotated[Positive, Field(alias="speed_m/s")]
    force_N: Size | None = None


class OpenLimits(_Part):
    """Of rig and damper, as the manifest gives them."""

    stroke_m: Positive | None
    velocity_m_s: Annotated[Positive | None, Field(alias="velocity_m/s")]
    current_A: Positive | None
    frequency_Hz: Positive | None
    force_N: Positive | None = None


class OpenErrors(_Part):
    """Errors of a further test: noise of a coefficient of its cycle mean, and sizes of Σ."""

    noise_N: Positive
    sizes: dict[str, Size]


class OpenFile(_Part):
    """The whole file."""

    format: Literal["sysid-open-1"]
    answer: str
    model: str
    errors: OpenErrors
    conditions: OpenConditions
    limits: OpenLimits
    alternatives: tuple[OpenAlternative, ...]
    questions: tuple[OpenQuestion, ...]
    told: tuple[OpenTold, ...]
