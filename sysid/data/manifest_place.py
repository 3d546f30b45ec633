"""Where in a manifest's text a key stands, for errors."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

Key = Sequence[str | int]
"""Parts of a key; a number is a place in a list, from 0."""


def place_of(path: Path, text: str, key: Key) -> str:
    """``file, line n, key a.b``, with the line where the key stands if it can be found.

    Args:
        path: The file.
        text: Its content.
        key: Of what is looked for.
    """
    line = line_of(text, key)
    name = key_name(key)
    return f"{path}, {name}" if line is None else f"{path}, line {line}, {name}"


def key_name(key: Key) -> str:
    """A key as people say it: ``a.b[1]``, counted from 1.

    Args:
        key: Its parts.
    """
    return "".join(f"[{z + 1}]" if isinstance(z, int) else f".{z}" for z in key)[1:]


def line_of(text: str, key: Key) -> int | None:
    """Line, from 1, on which a key (or the nearest table around it) is written.

    Args:
        text: The manifest.
        key: Of what is looked for.
    """
    best: tuple[int, int] | None = None
    for number, written in _keys(text):
        if list(key[: len(written)]) == written and (best is None or len(written) > best[0]):
            best = (len(written), number)
    if best is None:
        return None
    length, line = best
    inside = key[length] if key[length:] else None
    return _line_of_brace(text.splitlines(), line, inside) if isinstance(inside, int) else line


def _keys(text: str) -> Iterator[tuple[int, list[str | int]]]:
    """Line and whole key of each heading and entry; headings in [[ ]] are numbered."""
    section: list[str | int] = []
    seen: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        heading = re.match(r"\s*(\[+)\s*([^\]]+?)\s*\]+", line)
        if heading:
            section = [*_parts(heading[2])]
            if heading[1] == "[[":
                count = seen[heading[2]] = seen.get(heading[2], -1) + 1
                section.append(count)
            yield number, section
        elif entry := re.match(r"\s*([^=#]+?)\s*=", line):
            yield number, [*section, *_parts(entry[1])]


def _parts(name: str) -> list[str]:
    return [part.strip().strip("\"'") for part in name.split(".")]


def _line_of_brace(lines: Sequence[str], first: int, place: int) -> int:
    """Where an inline table begins that stands at a place of a list which begins on a line."""
    depth, found = 0, -1
    for number, line in enumerate(lines[first - 1 :], start=first):
        for character in line.split("#")[0]:
            if character == "{":
                found += depth == 0
                if found == place:
                    return number
                depth += 1
            elif character == "}":
                depth -= 1
    return first
