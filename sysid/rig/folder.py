"""Writing a campaign's folder, whole or not at all."""

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from sysid.errors import OutputError


def write_folder(files: Mapping[str, bytes], folder: Path) -> None:
    """Write files into a new or empty folder, or over the same files of an earlier run.

    Everything is first written beside the folder, then moved in.

    Args:
        files: Path relative to the folder → content.
        folder: Is made if it is absent.

    Raises:
        OutputError: The folder holds other files, is no folder, or cannot be written.
    """
    _refuse_foreign(files, folder)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
        try:
            _fill(files, beside)
            _move(files, beside, folder)
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    except OSError as cause:
        raise OutputError(
            f"cannot be written: {cause.strerror or cause}",
            where=cause.filename or folder,
            advice="Give another folder with -o, or make room and permission there",
        ) from cause


def _refuse_foreign(files: Mapping[str, bytes], folder: Path) -> None:
    """Mixing two campaigns in a folder would make a third that nobody ran."""
    if not os.path.lexists(folder):
        return
    if not folder.is_dir():
        raise OutputError("is not a folder", where=folder, advice="Give a folder with -o")
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if not path.is_dir() and name not in files:
            raise OutputError(
                f"the folder holds {name!r}, which is not part of this campaign",
                where=folder,
                advice="Give an empty or new folder with -o",
            )


def _fill(files: Mapping[str, bytes], folder: Path) -> None:
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def _move(files: Mapping[str, bytes], source: Path, folder: Path) -> None:
    """In one step where the folder is new, else file by file."""
    source.chmod(0o755)
    if not folder.exists():
        source.rename(folder)
        return
    for name in files:
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        os.replace(source / name, target)
