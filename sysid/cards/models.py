"""Which classes a card's `model` and `effects` name, and what those say about its parameters."""

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Final

from sysid.cards.schema import Card, Effect, Parameter
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS, choices, effect_kind
from sysid.errors import CardError
from sysid.models.base import AbstractValve
from sysid.models.bouc_wen import BoucWen
from sysid.models.carreau import Carreau
from sysid.models.dahl import Dahl
from sysid.models.damper import Damper
from sysid.models.generalized import Generalized
from sysid.models.lumped import Lumped
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.models.tanh_kwok import TanhKwok
from sysid.parameters import ParamSpec, build, specs, tables_of

MODELS: Final[Mapping[str, type[AbstractValve]]] = {
    "generalized": Generalized,
    "tanh": TanhKwok,
    "dahl": Dahl,
    "bouc_wen": BoucWen,
    "modified_bouc_wen": ModifiedBoucWen,
    "carreau": Carreau,
    "lumped": Lumped,
}
"""Name in cards and on the command line → valve model."""


def damper_of(card: Card, *, where: str = "card") -> Damper:
    """The damper that a card describes: its model, and its effects in the card's order.

    Args:
        card: The card.
        where: Its file, for errors.

    Raises:
        CardError: The model or an effect is not known here, or an effect stands at another stage
            or in a form that it does not have; a parameter is missing, not known, in another unit,
            or outside its own bounds.
    """
    kind = MODELS.get(card.model)
    if kind is None:
        raise CardError(
            f"model {card.model!r} is not known",
            where=f"{where}, model",
            advice=f"This program knows: {', '.join(MODELS)}",
        )
    owner = f"model {card.model!r}"
    tables = tables_of(kind, [parameter.symbol for parameter in card.parameters])
    if not all(tables.values()):
        raise CardError(
            f"{owner} has parameters at some currents; this card names none",
            where=f"{where}, parameters",
        )
    values = _values(card.parameters, specs(kind, tables), "", owner, where)
    prefixes = effect_prefixes([effect.id for effect in card.effects])
    effects = tuple(
        _effect(effect, prefix, f"{where}, effects[{k}]", f"{where}, effects[{k}].")
        for k, (effect, prefix) in enumerate(zip(card.effects, prefixes, strict=True))
    )
    return Damper(build(kind, values), effects)


def effect_prefixes(ids: Sequence[str]) -> tuple[str, ...]:
    """What stands before the symbols of each effect in a card: ``gas_spring.``.

    An effect that comes in several forms may be there more than once; the second time it is
    ``frequency_law-2.``, and so on.
    """
    counts = [list(ids[:k]).count(id) for k, id in enumerate(ids)]
    return tuple(f"{id}-{n + 1}." if n else f"{id}." for id, n in zip(ids, counts, strict=True))


def _effect(effect: Effect, prefix: str, place: str, inside: str) -> AbstractEffect:
    try:
        kind = effect_kind(effect.id)
    except KeyError:
        near = get_close_matches(effect.id, [e.facts.id for e in EFFECTS], n=3)
        known = f"It knows: {', '.join(near)}" if near else "Update sysid"
        raise CardError(
            f"effect {effect.id!r} is not known to this program",
            where=f"{inside}id",
            advice=known,
        ) from None
    if effect.stage != kind.stage:
        raise CardError(
            f"effect {effect.id!r} acts at stage {kind.stage!r}, not {effect.stage!r}",
            where=f"{inside}stage",
            advice="The card was altered by hand; write it again",
        )
    forms = choices(kind)
    if effect.choice not in forms:
        raise CardError(
            f"effect {effect.id!r} has no form {_form(effect.choice)}",
            where=f"{inside}choice",
            advice=f"It has: {', '.join(map(_form, forms))}",
        )
    owner = f"effect {effect.id!r}"
    values = _values(effect.parameters, specs(kind), prefix, owner, place, joint=".")
    return kind(**values, **effect.choice)


def _form(choice: Mapping[str, str | int]) -> str:
    return " and ".join(f"{k} = {v}" for k, v in choice.items()) or "with a choice left out"


def _values(
    parameters: Sequence[Parameter],
    declared: Sequence[ParamSpec],
    prefix: str,
    owner: str,
    where: str,
    joint: str = ", ",
) -> dict[str, float]:
    """Symbol → value of one model or effect, each held against its declaration."""
    known = {f"{prefix}{spec.symbol}": spec for spec in declared}
    values: dict[str, float] = {}
    for index, parameter in enumerate(parameters):
        place = f"{where}{joint}parameters[{index}]"
        spec = known.get(parameter.symbol)
        if spec is None:
            raise CardError(
                f"{owner} has no parameter {parameter.symbol!r}",
                where=f"{place}.symbol",
                advice=f"It has: {', '.join(known)}",
            )
        if parameter.unit != spec.unit:
            raise CardError(
                f"the unit of {parameter.symbol} is {spec.unit}, not {parameter.unit}",
                where=f"{place}.unit",
                advice="Cards hold SI units; do not convert them by hand",
            )
        fault = spec.check(parameter.value)
        if fault is not None:
            raise CardError(fault, where=f"{place}.value", advice=f"{spec.symbol}: {spec.name}")
        values[spec.symbol] = parameter.value
    missing = [symbol for symbol, spec in known.items() if spec.symbol not in values]
    if missing:
        raise CardError(
            f"{owner} lacks parameter{'s' if missing[1:] else ''} {', '.join(missing)}",
            where=f"{where}{joint}parameters",
        )
    return values
