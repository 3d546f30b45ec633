"""Sealed truth: what a virtual damper and its bench really are, kept from accidental eyes.

A seal is a JSON file whose content is base64 text, with the SHA-256 of what is inside.  It hides
nothing from a reader who wants to know; it keeps the truth out of searches, of glances and of any
program that reads numbers.  It is not compressed, because compression libraries differ in their
bytes and a dataset must be rebuilt byte for byte.
"""

import base64
import binascii
import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from sysid.errors import DataError

SCHEMA: Final = "sysid-sealed-truth-1"
SEAL_FILE: Final = "sealed/truth.json"
"""In a dataset's folder."""
_LINE: Final = 96


@dataclass(frozen=True)
class Truth:
    """Everything that was drawn or chosen for a virtual campaign, SI.

    Attributes:
        scenario: Its id.
        seed: Of the random numbers.
        model: Name of the damper's law.
        parameters: Symbol → value.
        effects: Hidden effects, each with its id and parameters.
        tests: File stem → what was true in that test (motion and errors).
    """

    scenario: str
    seed: int
    model: str
    parameters: Mapping[str, float]
    effects: tuple[Mapping[str, Any], ...]
    tests: Mapping[str, Mapping[str, Any]]


def seal(truth: Truth) -> tuple[str, str]:
    """Make the text of a sealed file.

    Returns:
        The text, and the SHA-256 of what is inside, hexadecimal.
    """
    inside = json.dumps(asdict(truth), sort_keys=True, ensure_ascii=True).encode("ascii")
    digest = hashlib.sha256(inside).hexdigest()
    coded = base64.b64encode(inside).decode("ascii")
    lines = [coded[k : k + _LINE] for k in range(0, len(coded), _LINE)]
    envelope = {"schema": SCHEMA, "sha256": digest, "sealed": lines}
    return json.dumps(envelope, indent=1) + "\n", digest


def open_seal(path: Path) -> Truth:
    """Open a sealed file.

    Raises:
        DataError: It cannot be read, is no seal, or was changed since it was sealed.
    """
    try:
        envelope = json.loads(path.read_text(encoding="ascii"))
        schema, digest, lines = (envelope[key] for key in ("schema", "sha256", "sealed"))
        inside = base64.b64decode("".join(lines), validate=True)
    except OSError as cause:
        raise DataError(
            f"the sealed truth cannot be read: {cause.strerror or cause}",
            where=path,
            advice="Rebuild the dataset with `sysid rig`",
        ) from cause
    except (ValueError, KeyError, TypeError, binascii.Error) as cause:
        raise DataError("is no sealed truth", where=path) from cause
    if schema != SCHEMA:
        raise DataError(f"schema {schema!r} is not {SCHEMA!r}", where=path)
    if hashlib.sha256(inside).hexdigest() != digest:
        raise DataError(
            "the truth was changed after it was sealed",
            where=path,
            advice="Rebuild the dataset with `sysid rig`",
        )
    content = json.loads(inside)
    return Truth(**{**content, "effects": tuple(content["effects"])})
