"""Source texts of exported programs, which lie beside this module, and their marks."""

import re
from collections.abc import Mapping
from importlib.resources import files
from typing import Final

_DEFINED: Final = re.compile(r"^static (?:const )?\w+ \**(\w+)[(\[ ]", re.MULTILINE)
"""A static function or constant at the beginning of a line."""


def source(name: str) -> str:
    """A source file as it is, by its path under `c/`."""
    return (files("sysid.cards.export") / "c" / name).read_text(encoding="utf-8")


def filled(name: str, marks: Mapping[str, str]) -> str:
    """A source file with every ``$MARK$`` replaced."""
    text = source(name)
    for mark, value in marks.items():
        text = text.replace(f"${mark}$", value)
    return text


def without_unused(text: str) -> str:
    """A source without static functions and constants that nothing uses.

    Definitions stand apart by empty lines, outside of which none begins in the first column.
    """
    chunks = re.split(r"\n\n(?=\S)", text)
    while True:
        whole = "\n\n".join(chunks)
        idle = [
            chunk
            for chunk in chunks
            if (found := _DEFINED.search(chunk)) and len(re.findall(rf"\b{found[1]}\b", whole)) == 1
        ]
        if not idle:
            return whole
        chunks = [chunk for chunk in chunks if chunk not in idle]
