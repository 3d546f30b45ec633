"""Results of long work on disk: one JSON object a line, each whole, so that the work can go on."""

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sysid.errors import OutputError


def read_rows(file: Path) -> list[dict[str, Any]]:
    """All rows; a line that was cut off when the machine stopped does not count.

    Args:
        file: May be absent.

    Raises:
        OutputError: It cannot be read.
    """
    return [row for _, row in numbered_rows(file)]


def numbered_rows(file: Path) -> list[tuple[int, dict[str, Any]]]:
    """As `read_rows`, each row behind the number of its line, from 1.

    Raises:
        OutputError: It cannot be read.
    """
    try:
        lines = file.read_bytes().splitlines() if file.exists() else ()
    except OSError as cause:
        raise OutputError(f"cannot be read: {cause.strerror}", where=file) from cause
    rows = []
    for number, line in enumerate(lines, start=1):
        try:
            row = json.loads(line)
        except ValueError:
            continue
        if isinstance(row, dict):
            rows.append((number, row))
    return rows


def add_row(row: Mapping[str, Any], file: Path) -> None:
    """Add a row, on a line of its own also where the last one was cut off, and see it on the disk.

    Args:
        row: What `json` can write.
        file: Is made, with its folder, if absent.

    Raises:
        OutputError: It cannot be written.
    """
    line = json.dumps(row, ensure_ascii=False).encode() + b"\n"
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("ab+") as out:
            if out.tell():
                out.seek(-1, os.SEEK_END)
                line = line if out.read(1) == b"\n" else b"\n" + line
            out.write(line)
            out.flush()
            os.fsync(out.fileno())
    except OSError as cause:
        raise OutputError(
            f"cannot be written: {cause.strerror}",
            where=file,
            advice="Make room and permission there, then give the same command again: it goes on",
        ) from cause


def shortened(value: Any, digits: int = 5) -> Any:
    """The same with floats of few digits, for lines that stay with the results.

    Args:
        value: Of objects and lists, as JSON has them.
        digits: Significant ones.
    """
    if isinstance(value, float):
        return float(f"{value:.{digits}g}")
    if isinstance(value, dict):
        return {k: shortened(v, digits) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [shortened(v, digits) for v in value]
    return value


def strict(value: Any) -> Any:
    """The same with null for what is no number, as everyone's JSON has it.

    Args:
        value: Of objects and lists; rows keep ``NaN``, which only Python reads.
    """
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {k: strict(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [strict(v) for v in value]
    return value
