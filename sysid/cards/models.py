"""Which class a card's `model` names, and what that class says about the card's parameters."""

from collections.abc import Mapping
from typing import Final

from sysid.cards.schema import Card
from sysid.errors import CardError
from sysid.models.base import AbstractValve
from sysid.models.bouc_wen import BoucWen
from sysid.models.dahl import Dahl
from sysid.models.generalized import Generalized
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.models.tanh_kwok import TanhKwok
from sysid.parameters import build, specs

MODELS: Final[Mapping[str, type[AbstractValve]]] = {
    "generalized": Generalized,
    "tanh": TanhKwok,
    "dahl": Dahl,
    "bouc_wen": BoucWen,
    "modified_bouc_wen": ModifiedBoucWen,
}
"""Name in cards and on the command line → valve model."""


def valve_of(card: Card, *, where: str = "card") -> AbstractValve:
    """The valve model that a card describes.

    Args:
        card: The card.
        where: Its file, for errors.

    Raises:
        CardError: The model or an effect is not known here; a parameter is missing, not known, in
            another unit, or outside its own bounds.
    """
    kind = MODELS.get(card.model)
    if kind is None:
        raise CardError(
            f"model {card.model!r} is not known",
            where=f"{where}, model",
            advice=f"This program knows: {', '.join(MODELS)}",
        )
    if card.effects:
        raise CardError(
            f"effect {card.effects[0].id!r} is not known",
            where=f"{where}, effects[0].id",
            advice="This program simulates valves without effects; update sysid",
        )
    known = {spec.symbol: spec for spec in specs(kind)}
    for index, parameter in enumerate(card.parameters):
        place = f"{where}, parameters[{index}]"
        spec = known.get(parameter.symbol)
        if spec is None:
            raise CardError(
                f"model {card.model!r} has no parameter {parameter.symbol!r}",
                where=f"{place}.symbol",
                advice=f"It has: {', '.join(known)}",
            )
        if parameter.unit != spec.unit:
            raise CardError(
                f"the unit of {spec.symbol} is {spec.unit}, not {parameter.unit}",
                where=f"{place}.unit",
                advice="Cards hold SI units; do not convert them by hand",
            )
        fault = spec.check(parameter.value)
        if fault is not None:
            raise CardError(fault, where=f"{place}.value", advice=f"{spec.symbol}: {spec.name}")
    values = card.values()
    missing = [symbol for symbol in known if symbol not in values]
    if missing:
        raise CardError(
            f"model {card.model!r} lacks parameter{'s' if missing[1:] else ''} "
            f"{', '.join(missing)}",
            where=f"{where}, parameters",
        )
    return build(kind, values)
