"""Reading a card, and refusing what is none with file and place."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

from pydantic import ValidationError

from sysid.cards.migrate import migrate
from sysid.cards.schema import Card
from sysid.errors import CardError


def read_card(path: Path, *, check: bool = True) -> Card:
    """Read a card.

    Args:
        path: The JSON file.
        check: Also hold the parameters against the model's own bounds and units, and recompute the
            check vectors (this loads JAX).  Without it only the card's form is checked.

    Raises:
        CardError: The file cannot be read, is no card, is of a newer version, holds a wrong value,
            or its check vectors do not come out.
    """
    card = parse_card(_text(path), where=str(path))
    if check:
        from sysid.cards.verify import verify

        verify(card, where=str(path))
    return card


def parse_card(text: str, *, where: str) -> Card:
    """A card from its JSON text; the form is checked, the check vectors are not recomputed.

    Raises:
        CardError: As `read_card`.
    """
    raw = migrate(_object(text, where), where=where)
    try:
        return Card.model_validate(raw, by_alias=True, by_name=False)
    except ValidationError as cause:
        raise _refusal(cause, where) from cause


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as cause:
        raise CardError(
            "is not UTF-8 text", where=path, advice="Give a card.json that `sysid fit` wrote"
        ) from cause
    except OSError as cause:
        raise CardError(
            f"the card cannot be read: {cause.strerror or cause}",
            where=path,
            advice="Give the path of a card.json that can be read",
        ) from cause


def _object(text: str, where: str) -> dict[str, Any]:
    """The outermost JSON object; repeated keys and numbers that are none are refused."""

    def pairs(items: list[tuple[str, Any]]) -> dict[str, Any]:
        seen: dict[str, Any] = {}
        for key, value in items:
            if key in seen:
                raise CardError(
                    f"key {key!r} stands twice in one object",
                    where=where,
                    advice="Remove one of the two",
                )
            seen[key] = value
        return seen

    def constant(name: str) -> NoReturn:
        raise CardError(
            f"{name} stands where a number must",
            where=where,
            advice="Numbers in a card are finite; write null where the format allows it",
        )

    try:
        raw = json.loads(text, object_pairs_hook=pairs, parse_constant=constant)
    except json.JSONDecodeError as cause:
        raise CardError(
            f"is not valid JSON: {cause.msg}",
            where=f"{where}, line {cause.lineno}, column {cause.colno}",
            advice="The file may be cut off; write it again with `sysid fit`",
        ) from cause
    except (RecursionError, ValueError) as cause:
        raise CardError(
            "is no readable JSON: nested too deep, or a number with too many digits", where=where
        ) from cause
    if not isinstance(raw, dict):
        raise CardError(
            "is no model card: its outermost JSON value is not an object",
            where=where,
            advice="Give a card.json that `sysid fit` wrote",
        )
    return raw


def _refusal(cause: ValidationError, where: str) -> CardError:
    """The first complaint of pydantic as a sentence with its JSON path."""
    complaint = cause.errors()[0]
    place = json_path(complaint["loc"])
    kind, message = complaint["type"], complaint["msg"]
    more = len(cause.errors()) - 1
    advice = f"There are {more} more faults in this card" if more else None
    if kind == "extra_forbidden":
        what = "this key is not known"
    elif kind == "missing":
        what = "this key is missing"
    elif kind == "value_error":
        what = message.removeprefix("Value error, ")
    else:
        what = f"{_shown(complaint['input'])} is refused: {message[:1].lower()}{message[1:]}"
    return CardError(what, where=f"{where}, {place}" if place else where, advice=advice)


def json_path(loc: tuple[int | str, ...]) -> str:
    """Where something stands in a JSON file, like ``parameters[3].value``."""
    return "".join(_steps(loc)).lstrip(".")


def _steps(loc: tuple[int | str, ...]) -> Iterator[str]:
    for part in loc:
        yield f"[{part}]" if isinstance(part, int) else f".{part}"


def _shown(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= 60 else f"{text[:57]}…"
