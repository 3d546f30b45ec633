"""Writing a card: the same card gives the same bytes, on every machine."""

import json
import re
from pathlib import Path
from typing import Any

from sysid.cards.schema import Card
from sysid.data.whole_file import write_text

_LIST_OF_NUMBERS = re.compile(r"\[\n\s*((?:-?\d[\d.eE+-]*,?\s*)+)\n\s*\]")


def write_card(card: Card, path: Path) -> None:
    """Write a card whole or not at all.

    Raises:
        OutputError: It cannot be written; nothing is left behind then.
    """
    write_text(path, card_text(card))


def card_text(card: Card) -> str:
    """A card's file content: keys in the format's order, numbers with every digit."""
    return json_text(card.model_dump(mode="json", by_alias=True))


def json_text(value: Any) -> str:
    """JSON as all results are written: two blanks a level, lists of numbers on one line.

    Python writes the shortest digits that read back to the same float, so nothing is rounded.
    """
    text = json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)
    # A line end inside a JSON string is written \n: real line ends are never part of a string.
    return _LIST_OF_NUMBERS.sub(lambda m: "[" + " ".join(m[1].split()) + "]", text) + "\n"
