"""Options that several commands share, and how their values are read."""

import re
from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Final, Literal

import typer

from sysid.errors import UnitError

Json = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON on stdout, all else on stderr.")
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of everything random.")]
UnusedSeed = Annotated[
    int, typer.Option("--seed", help="Accepted everywhere; nothing is random in this command.")
]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="No progress and no notes; warnings stay.")
]
ManifestOption = Annotated[
    Path | None,
    typer.Option("--manifest", metavar="FILE", help="A campaign.toml that lies elsewhere."),
]
FlipForce = Annotated[
    bool, typer.Option("--flip-force", help="Turn the sign of the measured force in every test.")
]
CampaignArgument = Annotated[
    Path,
    typer.Argument(metavar="CAMPAIGN", help="Folder of measured tests, or with a campaign.toml."),
]
CardArgument = Annotated[
    Path,
    typer.Argument(metavar="CARD", help="A card.json that `sysid fit` or `sysid diagnose` wrote."),
]


class Model(StrEnum):
    """Models that can be fitted."""

    generalized = "generalized"
    tanh = "tanh"
    dahl = "dahl"
    bouc_wen = "bouc_wen"
    modified_bouc_wen = "modified_bouc_wen"
    carreau = "carreau"
    lumped = "lumped"


VARIANTS: Final[Mapping[Model, tuple[str, ...]]] = {
    Model.generalized: ("asymmetric", "symmetric", "passive", "mean"),
    Model.tanh: ("full",),
    Model.dahl: ("full",),
    Model.bouc_wen: ("full",),
    Model.modified_bouc_wen: ("full",),
    Model.carreau: ("full",),
    Model.lumped: ("paper", "full"),
}
"""Model → its variants, the default first: those of `sysid.identification.families`, which would
load JAX."""

RANGE_OPTIONS: Final = ("--frequency-range", "--amplitude-range")
"""Options that take two values, LO HI."""

TYPED: Final = "COMMANDLINE"
"""What click calls the source of an option that was typed."""

Quantity = Literal["displacement", "frequency", "current", "temperature"]
_NUMBER: Final = re.compile(
    r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\d\s.,+-]\S*)?\s*"
)
_EXAMPLE: Final[dict[str, str]] = {
    "displacement": "12.5mm", "frequency": "1.5Hz", "current": "0.2A", "temperature": "40C",
}  # fmt: skip


def join_ranges(arguments: Sequence[str]) -> list[str]:
    """Join the two values of a range option to one argument, since typer knows lists of one value.

    ``--frequency-range 0.5 5`` becomes ``--frequency-range "0.5 5"``, which stays as it is where
    it was typed so.
    """
    joined: list[str] = []
    rest = list(arguments)
    while rest:
        word = rest.pop(0)
        joined.append(word)
        two = rest[:2]
        both = len(two) == 2 and not any(_is_option(z) for z in two)
        if word in RANGE_OPTIONS and both and len(_ends(two[0])) == 1:
            joined.append(" ".join(two))
            del rest[:2]
    return joined


def _ends(text: str) -> list[str]:
    """Quantities that stand in a text, each without spaces: ``2 mm 13mm`` are two."""
    return re.sub(r"(?<=[\d.])\s+(?=[^\d\s.+-])", "", text).split()


def _is_option(word: str) -> bool:
    return word.startswith("-") and not re.match(r"-\.?\d", word)


def typed(context: typer.Context) -> str:
    """The command line as it was typed, for results to say how they came about."""
    return context.obj if isinstance(context.obj, str) else ""


def given(context: typer.Context, *names: str) -> tuple[str, ...]:
    """Those of some options that stand on the command line, as they are written there.

    Args:
        context: Of the command.
        names: Of its parameters, as Python has them.
    """
    typed_so = (n for n in names if getattr(context.get_parameter_source(n), "name", "") == TYPED)
    return tuple(f"--{name.replace('_', '-')}" for name in typed_so)


def variant_of(model: Model, variant: str | None) -> str:
    """The variant of a model; its default where none is asked.

    Raises:
        typer.BadParameter: The model has no such variant.
    """
    known = VARIANTS[model]
    if variant is None:
        return known[0]
    if variant not in known:
        raise typer.BadParameter(
            f"the {model.value} model has no variant {variant!r}; it has: {', '.join(known)}",
            param_hint="--variant",
        )
    return variant


def quantity(text: str, kind: Quantity, option: str, bare: str | None = None) -> float:
    """A number with its unit, such as ``12.5mm``, in SI.

    Args:
        text: What the user wrote.
        kind: Which quantity it must be.
        option: The option's name, for the message.
        bare: Unit of a number without one; None where a unit must be given.

    Raises:
        typer.BadParameter: No number, no unit, or a unit of something else.
    """
    from sysid.units import find_unit, to_si

    match = _NUMBER.fullmatch(text)
    if match is None or not (match[2] or bare):
        raise typer.BadParameter(
            f"{text!r} is not a number with a unit; write for example {_EXAMPLE[kind]}",
            param_hint=option,
        )
    try:
        unit = find_unit(match[2] or bare or "", kind)
    except UnitError as cause:
        raise typer.BadParameter(str(cause), param_hint=option) from cause
    value = float(to_si(float(match[1]), unit))
    if value != value or abs(value) == float("inf"):
        raise typer.BadParameter(f"{text!r} is too large", param_hint=option)
    return value


def duration(text: str, option: str) -> float:
    """A time such as ``60s`` or ``5min``, in s; a bare number is in s.

    Raises:
        typer.BadParameter: No such time, or not above zero.
    """
    match = re.fullmatch(r"\s*(\d+\.?\d*|\.\d+)\s*(s|min|h)?\s*", text)
    seconds = (
        0.0 if match is None else float(match[1]) * {"min": 60.0, "h": 3600.0}.get(match[2], 1.0)
    )
    if not 0.0 < seconds < float("inf"):
        raise typer.BadParameter(
            f"{text!r} is not a time; write for example 60s or 5min", param_hint=option
        )
    return seconds


def span(text: str, kind: Quantity, option: str, bare: str) -> tuple[float, float]:
    """Two ends of a range, ``LO HI``, in SI.

    Raises:
        typer.BadParameter: Not two quantities, or the first is above the second.
    """
    ends = _ends(text)
    if len(ends) != 2:
        raise typer.BadParameter(
            f"two values LO HI are needed, not {text!r}; write for example {option} 0.5 5",
            param_hint=option,
        )
    low, high = (quantity(end, kind, option, bare) for end in ends)
    if low > high:
        raise typer.BadParameter(f"LO is above HI in {text!r}", param_hint=option)
    return low, high
