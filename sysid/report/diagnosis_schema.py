"""What `diagnosis.json` is made of; unknown numbers are null, everything is SI.

The JSON Schema `diagnosis-1.schema.json` beside this module is made from these classes.
"""

from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

SCHEMA: Final = "sysid-diagnosis-1"

KEYS: Final = {"format": "schema", "members": "class"}
"""Attribute → key in the file, where they differ."""

Number = Annotated[float, Field(allow_inf_nan=False)]
Unsure = Number | None


class _Part(BaseModel):
    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        validate_by_name=True,
        alias_generator=lambda name: KEYS.get(name, name),
    )


class Parameter(_Part):
    """A parameter of a cause."""

    value: Unsure
    unit: str
    low: Unsure
    high: Unsure
    level: Number
    sd: Unsure
    name: str
    identified: bool


class Cause(_Part):
    """An effect that is asserted; `id` is null for a family.

    One that was found in the cycles (`from_cycles`) is in no card: it was taken out of the tests.
    One that the base model holds in its own parameters (`in_base`) is none of the card's effects.
    """

    id: str | None
    status: Literal["named", "class", "family"]
    members: tuple[str, ...]
    family: str
    parameters: dict[str, Parameter]
    confidence: Unsure
    because: str
    separating_test: str | None
    score: Unsure
    share: Unsure
    extra_error_N: Unsure
    stability: Unsure
    from_cycles: bool
    in_base: bool


class Invisible(_Part):
    """An effect that these tests cannot show."""

    id: str
    because: str
    test: str


class Dependence(_Part):
    """How much of what remains goes with one quantity, on unseen conditions."""

    quantity: str
    share: Unsure
    alone: Unsure
    only: Unsure


class Joint(_Part):
    """A pair of quantities that says more than the sum of a function of each."""

    first: str
    second: str
    share: Unsure


class Anova(_Part):
    """With what the remaining error varies."""

    explained: Unsure
    constant: Unsure
    quantities: tuple[Dependence, ...]
    pairs: tuple[Joint, ...]


class Term(_Part):
    """A term that is proposed, not named; `removes` is a share on unseen conditions."""

    formula: str
    parity: str
    coefficient: Unsure
    unit: str
    sd: Unsure
    removes: Unsure
    se: Unsure
    agreed: Unsure


class Unknown(_Part):
    """What remains without a name."""

    present: bool
    parity: dict[str, Unsure]
    depends_on: tuple[str, ...]
    exponents: dict[str, Unsure]
    share_of_reducible: Unsure
    moves: str | None
    because: tuple[str, ...]
    anova: Anova | None
    proposal: tuple[Term, ...]
    strange: Unsure


class TestGain(_Part):
    """Error of one test, predicted by models fitted without its condition."""

    __test__ = False  # not a pytest class

    id: str
    nrmse_before: Unsure
    nrmse_after: Unsure


class Extrapolation(_Part):
    """Error on extreme conditions that were left out."""

    left_out: str
    nrmse_before: Unsure
    nrmse_after: Unsure


class Gain(_Part):
    """Worth of the extension on tests that were not fitted."""

    held_out_nrmse_before: Unsure
    held_out_nrmse_after: Unsure
    noise_floor_nrmse: Unsure
    reducible_explained: Unsure
    low: Unsure
    high: Unsure
    held_out: tuple[str, ...]
    repeatability_nrmse: Unsure
    tests: tuple[TestGain, ...]
    extrapolation: tuple[Extrapolation, ...]


class Screened(_Part):
    """An effect in the score screen."""

    id: str
    score: Unsure
    threshold: Unsure
    survival: Unsure
    expected_change: Unsure
    se: Unsure


class Rival(_Part):
    """A base model that was tried and not chosen."""

    model: str
    held_out_nrmse: Unsure
    variant: str
    extended_nrmse: Unsure
    admissible: bool


class Base(Rival):
    """The base model that was chosen."""

    rivals: tuple[Rival, ...]


class HeldOut(_Part):
    """A test that --holdout named: it entered nothing but this error."""

    id: str
    nrmse_before: Unsure
    nrmse_after: Unsure


class FreeRun(_Part):
    """The exported card, read back and simulated on every loop."""

    mean_nrmse: Unsure
    largest_deviation: Unsure


class DiagnosisJson(_Part):
    """The whole file."""

    format: Literal["sysid-diagnosis-1"]
    answer: Literal["named", "class", "family", "unknown", "nothing", "base_inadequate"]
    sentences: tuple[str, ...]
    causes: tuple[Cause, ...]
    invisible: tuple[Invisible, ...]
    unknown: Unknown
    gain: Gain | None
    screen: tuple[Screened, ...]
    base: Base
    holdout: tuple[HeldOut, ...]
    left_out: dict[str, str]
    free_run: FreeRun | None
    trusted: bool
    distrust: tuple[str, ...]
    notes: tuple[str, ...]


def json_schema() -> dict[str, Any]:
    """The published JSON Schema, as `diagnosis-1.schema.json` holds it."""
    body = DiagnosisJson.model_json_schema(by_alias=True, mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA, **body}
