"""Results on disk, whole or not at all: written beside their place first, then moved there."""

import os
import shutil
import tempfile
from collections.abc import Mapping
from errno import EISDIR
from pathlib import Path

from sysid.errors import OutputError


def write_text(path: Path, text: str) -> None:
    """Write a text file as UTF-8, whole or not at all.

    Raises:
        OutputError: The folder is missing or not writable, or the disk is full; nothing is left
            behind then, and a file that was there before is untouched.
    """
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, content: bytes) -> None:
    """As `write_text`, for bytes."""
    temporary: str | None = None
    try:
        handle, temporary = tempfile.mkstemp(prefix=".sysid-", dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, path)
        temporary = None
    except OSError as cause:
        raise cannot_write(path, cause) from cause
    finally:
        if temporary is not None and os.path.exists(temporary):
            os.unlink(temporary)


def write_files(files: Mapping[str, bytes], folder: Path) -> None:
    """Write several files into a folder, all of them or none.

    They are written into a hidden folder inside first and moved to their names at the end, so a
    full disk leaves what was there before as it was.

    Args:
        files: Name, or path relative to the folder with forward slashes → content.
        folder: Made, with its parents, if it does not exist.

    Raises:
        OutputError: They cannot be written, or a folder has the name of one.
    """
    for name in files:
        if (folder / name).is_dir():
            raise cannot_write(folder / name, OSError(EISDIR, os.strerror(EISDIR)))
    made = _make(folder)
    stage: Path | None = None
    try:
        stage = Path(tempfile.mkdtemp(prefix=".sysid-", dir=folder))
        for name, content in files.items():
            (stage / name).parent.mkdir(parents=True, exist_ok=True)
            with open(stage / name, "wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
        for name in files:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            os.replace(stage / name, folder / name)
    except OSError as cause:
        if stage is not None:
            shutil.rmtree(stage, ignore_errors=True)
        for path in reversed(made):
            if path.is_dir() and not any(path.iterdir()):
                path.rmdir()
        raise cannot_write(folder, cause) from cause
    shutil.rmtree(stage, ignore_errors=True)


def need_writable(folder: Path) -> None:
    """Refuse a folder that could not be written, before hours are spent on what goes into it.

    Raises:
        OutputError: It, or the nearest folder above it that exists, may not be written to.
    """
    place = folder
    while not os.path.lexists(place) and place != place.parent:
        place = place.parent
    if not place.is_dir():
        raise OutputError("is a file, not a folder", where=place, advice="Give another place (-o)")
    if not os.access(place, os.W_OK | os.X_OK):
        raise OutputError("may not be written to", where=place, advice="Give another place (-o)")


def _make(folder: Path) -> list[Path]:
    """Make a folder with its parents; returns those that did not exist, outermost first."""
    missing = [p for p in (folder, *folder.parents) if not os.path.lexists(p)][::-1]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as cause:
        raise cannot_write(folder, cause) from cause
    return missing


def cannot_write(path: Path, cause: OSError) -> OutputError:
    """What to tell a user whose result cannot be written."""
    return OutputError(
        f"cannot be written: {(cause.strerror or str(cause)).lower()}",
        where=path,
        advice="Give a place that exists, may be written to and has room (-o); "
        "nothing was left half-written",
    )


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
