"""Older cards made readable: pure functions from one version's dict to the next one's.

A card's version is the number at the end of its ``schema`` key.  Version 1 is the first, so the
table is empty; a change of format adds one function and one line.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any, Final

from sysid.cards.schema import SCHEMA
from sysid.errors import CardError

Migration = Callable[[dict[str, Any]], dict[str, Any]]

MIGRATIONS: Final[Mapping[int, Migration]] = {}
"""Version n → function that makes a card of version n + 1 of it."""

_NAME: Final = re.compile(r"sysid-card-([1-9]\d{0,5})")
CURRENT: Final = int(SCHEMA.rsplit("-", 1)[1])


def migrate(
    raw: dict[str, Any],
    *,
    where: str,
    migrations: Mapping[int, Migration] = MIGRATIONS,
    current: int = CURRENT,
) -> dict[str, Any]:
    """Bring a card's dict to the current version.

    Args:
        raw: As read from JSON; it is not altered.
        where: The file, for errors.
        migrations: The table of migrations.
        current: The version to arrive at.

    Raises:
        CardError: No version, or a newer one than this program knows.
    """
    version = _version(raw, where)
    if version > current:
        raise CardError(
            f"is a card of version {version}, this program reads versions up to {current}",
            where=f"{where}, schema",
            advice="Update sysid (pip install --upgrade sysid)",
        )
    while version < current:
        raw = migrations[version](dict(raw))
        version += 1
        raw = {**raw, "schema": f"sysid-card-{version}"}
    return raw


def _version(raw: dict[str, Any], where: str) -> int:
    if "schema" not in raw:
        raise CardError(
            "is no model card: the key 'schema' is missing",
            where=where,
            advice=f'A card begins with "schema": "{SCHEMA}"',
        )
    match = _NAME.fullmatch(raw["schema"]) if isinstance(raw["schema"], str) else None
    if match is None:
        raise CardError(
            f"schema {str(raw['schema'])[:60]!r} is not that of a model card",
            where=f"{where}, schema",
            advice=f'Give a card.json that `sysid fit` wrote ("schema": "{SCHEMA}")',
        )
    return int(match[1])
