"""Parameters with their intervals; no number where the tests give none."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from sysid.cards.schema import Card, Parameter
from sysid.diagnosis.words import NOT_DETERMINED
from sysid.report.page.wording import UNKNOWN


@dataclass(frozen=True)
class ParameterRow:
    """One parameter.

    Attributes:
        symbol: As in the card.
        name: In words.
        unit: SI.
        value: As text.
        interval: Both ends, "fixed", or that it is not determined.
        determined: It is.
        drawn: Interval of the posterior; a dash where nothing was drawn.
    """

    symbol: str
    name: str
    unit: str
    value: str
    interval: str
    determined: bool
    drawn: str


@dataclass(frozen=True)
class ParameterTable:
    """The parameters of one card.

    Attributes:
        card: Its name on the page.
        interval: What the intervals are.
        drawn: What those of the posterior are; empty where nothing was drawn.
        rows: The model's, then those of its effects.
        discrepancies: What the user of the card must know.
    """

    card: str
    interval: str
    drawn: str
    rows: tuple[ParameterRow, ...]
    discrepancies: tuple[str, ...]


def parameter_table(card: Card, name: str = "card.json") -> ParameterTable:
    """Gather the parameters of a card and of its effects."""
    posterior = card.posterior
    ends: Mapping[str, tuple[float, float, bool]] = {}
    if posterior is not None:
        ends = {p.symbol: (p.low, p.high, p.identified) for p in posterior.parameters}
    own = [*card.parameters, *(p for effect in card.effects for p in effect.parameters)]
    return ParameterTable(
        card=name,
        interval=card.interval,
        drawn="" if posterior is None else posterior.interval,
        rows=tuple(_row(p, ends.get(p.symbol)) for p in own),
        discrepancies=card.known_discrepancies,
    )


def _row(p: Parameter, drawn: tuple[float, float, bool] | None) -> ParameterRow:
    if not p.identified:
        value, told = UNKNOWN, NOT_DETERMINED
    elif not p.sd:
        value, told = f"{p.value:.5g}", "fixed"
    else:
        value, told = f"{p.value:.5g}", _ends(p.low, p.high)
    posterior = UNKNOWN
    if drawn is not None:
        posterior = _ends(*drawn[:2]) if drawn[2] else NOT_DETERMINED
    return ParameterRow(
        p.symbol, p.name, "" if p.unit == "-" else p.unit, value.replace("-", "−"), told,
        p.identified, posterior,
    )  # fmt: skip


def _ends(low: float | None, high: float | None) -> str:
    known = [z for z in (low, high) if z is not None and math.isfinite(z)]
    return f"{low:.5g} … {high:.5g}".replace("-", "−") if len(known) == 2 else UNKNOWN
