"""Bytes of a text file → text, with the encoding recognised or refused."""

import codecs
import re
from pathlib import Path
from typing import Final

from sysid.data.advice import into_manifest
from sysid.errors import DataError

_MARKS: Final[tuple[tuple[bytes, str], ...]] = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
"""Byte-order marks; UTF-32 stands first because its mark begins like that of UTF-16."""

_CONTROL: Final = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f-\x9f]")


def decode(data: bytes, path: Path, encoding: str | None = None) -> str:
    r"""Decode a text file and make its line ends ``\n``.

    A byte-order mark decides; else UTF-8, then UTF-16 without a mark where every other byte is
    zero, then Western European (Windows-1252).  Text with control characters is refused.

    Args:
        data: The whole file.
        path: For the message.
        encoding: From the manifest; then nothing is tried.

    Raises:
        DataError: The bytes are not text in any encoding that is tried.
    """
    names = (encoding,) if encoding else _candidates(data)
    for name in names:
        try:
            text = data.decode(name)
        except LookupError as cause:
            raise DataError(
                f"encoding {name!r} of the manifest is not known",
                where=path,
                advice="Write for example utf-8, utf-16, latin-1 or shift_jis",
            ) from cause
        except ValueError:  # UnicodeDecodeError, and what odd codecs raise
            continue
        if isinstance(text, str) and not _CONTROL.search(text):
            return text.replace("\r\n", "\n").replace("\r", "\n").replace("\ufeff", "")
    what = f"is not text in encoding {encoding}" if encoding else "is not text in a known encoding"
    raise DataError(
        f"{what}, or is damaged{_first_fault(data)}",
        where=path,
        advice="Save it as UTF-8, or, if its text is for example Japanese, "
        + into_manifest("files", 'encoding = "shift_jis"', has=encoding is not None),
    )


def _candidates(data: bytes) -> tuple[str, ...]:
    for mark, name in _MARKS:
        if data.startswith(mark):
            return (name,)
    head = data[:2000]
    if head[1::2].count(0) > 0.4 * len(head[1::2]) and not head[0::2].count(0):
        return ("utf-16-le",)
    if head[0::2].count(0) > 0.4 * len(head[0::2]) and not head[1::2].count(0):
        return ("utf-16-be",)
    return ("utf-8", "cp1252")


def _first_fault(data: bytes) -> str:
    at = data.find(b"\x00")
    if at < 0:
        return ""
    line = data.count(b"\n", 0, at) + 1
    return f" (a NUL byte in line {line})"
