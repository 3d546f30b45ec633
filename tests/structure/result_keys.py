"""docs/result-keys.md, read: which keys it has of each object of each file."""

import re
from collections.abc import Iterator, Mapping
from typing import Any, Final

from tests.structure.pages import DOCS

PAGE: Final = DOCS / "result-keys.md"
BY_NAME: Final = {
    "intervals[].parameters", "identifiability.profiles", "static_force.tests",
    "bands.not_known", "bands.tests[].mean_half_width_N", "causes[].parameters",
}  # fmt: skip
"""Objects whose keys are names of parameters, tests and the like: those stand as ``.*``."""

Keys = dict[str, set[str]]


def told(file: str) -> Keys:
    """Path of each object of a file → keys that the page explains; the file itself is ``""``.

    Args:
        file: Heading of its chapter, such as ``fit.json``.
    """
    text = PAGE.read_text(encoding="utf-8")
    (chapter,) = re.findall(
        rf"^## {re.escape(file)}\n(.*?)(?=^## |\Z)", text, re.DOTALL | re.MULTILINE
    )
    found: Keys = {}
    for part in re.split(r"^### ", f"\n{chapter}", flags=re.MULTILINE):
        head, _, body = part.partition("\n")
        firsts = re.findall(r"^\|([^|]*)\|", body, flags=re.MULTILINE)
        keys = {key for cell in firsts for key in re.findall(r"`([^`]+)`", cell)}
        for path in re.findall(r"`([^`]+)`", head) or [""]:
            found[path] = keys
    return found


def written(result: Any) -> Keys:
    """Path of each object of a JSON result → its keys, as `told`."""
    found: Keys = {}
    _walk(result, "", found)
    return found


def _walk(value: Any, path: str, found: Keys) -> None:
    if isinstance(value, list):
        for each in value:
            _walk(each, f"{path}[]", found)
    elif isinstance(value, Mapping) and path in BY_NAME:
        for each in value.values():
            _walk(each, f"{path}.*", found)
    elif isinstance(value, Mapping):
        found.setdefault(path, set()).update(value)
        for key, each in value.items():
            _walk(each, f"{path}.{key}".lstrip("."), found)


def published(schema: Mapping[str, Any]) -> Keys:
    """Path of each object of a JSON Schema → its keys, as `told`."""
    found: Keys = {}
    _declared(schema, schema, "", found)
    return found


def _declared(schema: Mapping[str, Any], part: Mapping[str, Any], path: str, found: Keys) -> None:
    for option in _options(schema, part):
        if "properties" in option:
            found.setdefault(path, set()).update(option["properties"])
            for key, each in option["properties"].items():
                _declared(schema, each, f"{path}.{key}".lstrip("."), found)
        elif "items" in option:
            _declared(schema, option["items"], f"{path}[]", found)
        elif isinstance(option.get("additionalProperties"), Mapping):
            _declared(schema, option["additionalProperties"], f"{path}.*", found)


def _options(schema: Mapping[str, Any], part: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """What a part may be, references followed."""
    if "$ref" in part:
        part = schema["$defs"][part["$ref"].rsplit("/", 1)[1]]
    if "anyOf" in part:
        for each in part["anyOf"]:
            yield from _options(schema, each)
    else:
        yield part


def missing(found: Keys, file: str) -> list[str]:
    """Keys that the page does not explain, with their paths."""
    explained = told(file)
    return sorted(
        f"{path}.{key}".lstrip(".")
        for path, keys in found.items()
        for key in keys - explained.get(path, set())
    )
