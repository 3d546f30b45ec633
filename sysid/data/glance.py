"""The first lines of a text file: enough to tell what it is not, without reading it."""

import re
from pathlib import Path
from typing import Final

from sysid.data.readers.base import number

_HEAD: Final = 4096
"""Bytes that are looked at."""
_MARKS: Final = b"\xff\xfe\xef\xbb\xbf"
"""Bytes of byte-order marks."""
_CELLS: Final = re.compile(r"[\s;]+")
_FEWEST: Final = 3
"""Numbers on a line of a test: time, displacement and force."""


def first_lines(path: Path) -> list[str]:
    """The lines at the beginning of a file, as well as they can be read; none where it cannot be.

    Args:
        path: Any file.
    """
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD).replace(b"\x00", b"").lstrip(_MARKS)  # ASCII in UTF-16
    except OSError:
        return []
    return head.decode("utf-8", "replace").splitlines()


def holds_numbers(path: Path) -> bool:
    """Whether some line at the beginning of a file may be a row of a test.

    Args:
        path: A text file.
    """
    return any(_is_row(line) for line in first_lines(path))


def _is_row(line: str) -> bool:
    """Three numbers at least, and not fewer than words."""
    for cells in (_CELLS.split(line.strip()), line.split(",")):
        filled = [cell for cell in cells if cell.strip()]
        numbers = sum(any(number(cell, sign) is not None for sign in ".,") for cell in filled)
        if numbers >= _FEWEST and 2 * numbers >= len(filled):
            return True
    return False
