"""What lies beside the files of a campaign: nothing that could be read is left out unsaid."""

import fnmatch
import os
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sysid.data.listing import LISTING, looks_like_listing
from sysid.data.readers import find_reader
from sysid.errors import DataError

MANIFEST: Final = "campaign.toml"
_ABOUT: Final = ("readme", "license", "licence", "changelog")
"""How names of texts begin that hold no test."""
_SHOWN: Final = 3


@dataclass(frozen=True)
class Beside:
    """A folder's content that is no manifest, no `tests.csv` and not hidden, by name.

    Attributes:
        readable: Files in a format that is read.
        others: All other files.
        folders: Sub-folders.
    """

    readable: tuple[Path, ...]
    others: tuple[Path, ...]
    folders: tuple[Path, ...]


def beside(folder: Path) -> Beside:
    """What is in a folder; what may not be looked at is passed over."""
    try:
        inside = [p for p in sorted(folder.iterdir()) if p.name.lower() not in (LISTING, MANIFEST)]
    except OSError:
        inside = []
    seen = [p for p in inside if not hidden(p)]
    files = [p for p in seen if _is(p, Path.is_file)]
    return Beside(
        readable=tuple(p for p in files if find_reader(p)),
        others=tuple(p for p in files if not find_reader(p)),
        folders=tuple(p for p in seen if _is(p, Path.is_dir)),
    )


def _is(path: Path, kind: Callable[[Path], bool]) -> bool:
    try:
        return kind(path)
    except OSError:
        return False


def matches(folder: Path, glob: str) -> list[Path]:
    """Files that a glob names, by name, upper and lower case alike, without `tests.csv`.

    Raises:
        DataError: The folder cannot be listed so.
    """
    try:
        if "/" in glob or "**" in glob:
            found = list(folder.glob(glob))
        else:
            found = [p for p in folder.iterdir() if fnmatch.fnmatch(p.name.lower(), glob.lower())]
    except (OSError, ValueError, NotImplementedError, RuntimeError) as cause:
        raise DataError(
            f"files matching {glob!r} cannot be listed: {cause}", where=folder
        ) from cause
    return sorted(p for p in found if p.name.lower() not in (LISTING, MANIFEST))


def hidden(path: Path) -> bool:
    """Whether a file's name says that it is not for people."""
    return path.name.startswith((".", "~$"))


def unread(folder: Path, glob: str, files: Collection[Path], *, below: bool = True) -> list[str]:
    """Sentences on files in a folder and in its sub-folders that could be read and are not.

    Args:
        folder: Where the data are.
        glob: Of the files that are read.
        files: Those that are read, or told of otherwise.
        below: Look into sub-folders, too.
    """
    there = beside(folder)
    taken = set(files)
    told = []
    left = [p for p in there.readable if p not in taken and not _about(p)]
    lists = [p for p in left if looks_like_listing(p)]
    told.extend(
        f"{shown(p)} in {folder} lists tests and is not read under this name: what it says of them "
        f"is not known. Rename it to {LISTING}, or move it elsewhere"
        for p in lists
    )
    left = [p for p in left if p not in lists]
    if left:
        told.append(
            f"{_count(left)} in {folder} {'is' if len(left) == 1 else 'are'} not read, since "
            f"{glob!r} does not match: {_some(left)}. Where they are tests, too, change `glob` "
            f"under [files] in {MANIFEST}, or give them a folder of their own"
        )
    inside = {
        p: [f for f in beside(p).readable if f not in taken and not _about(f)]
        for p in there.folders
        if below
    }
    inside = {p: found for p, found in inside.items() if found}
    if inside:
        all_of = [f for found in inside.values() for f in found]
        told.append(
            f"{_count(all_of)} in sub-folders of {folder} {'is' if len(all_of) == 1 else 'are'} "
            f"not read ({_some(list(inside))}). Where they are tests of another damper, read that "
            f"folder by itself; where of the same one, put all into one folder, or change `glob` "
            f"under [files] in {MANIFEST}"
        )
    return told


def loose(fleet: Path) -> list[str]:
    """A sentence on files that lie beside the sub-folders of a fleet, if there are any.

    Args:
        fleet: Folder of campaigns.
    """
    left = [p for p in beside(fleet).readable if not _about(p)]
    if not left:
        return []
    return [
        f"{_count(left)} beside the sub-folders of {fleet} {'is' if len(left) == 1 else 'are'} "
        f"not read: {_some(left)}. Put what is a test into the folder of its damper"
    ]


def misnamed(folder: Path, *, has: bool) -> list[str]:
    """Sentences on manifests and lists of tests that are not read because of their names.

    Args:
        folder: Where the data are.
        has: There is a manifest that is read.
    """
    told = []
    try:
        names = sorted(p.name for p in folder.iterdir())
    except OSError:
        return []
    told.extend(
        f"{folder / name} is not read: {LISTING} is there, too"
        for name in names
        if name != LISTING and name.lower() == LISTING and LISTING in names
    )
    if not has:
        told.extend(
            f"{folder / name} is not read, since only {MANIFEST} is: rename it, or give it with "
            "--manifest, if it is the manifest"
            for name in names
            if name.lower().endswith(".toml") and not name.startswith(".")
        )
    return told


def shown(path: Path) -> str:
    """A file's name as text that can be written anywhere."""
    return os.fsencode(path.name).decode("utf-8", "backslashreplace")


def _about(path: Path) -> bool:
    return path.name.lower().startswith(_ABOUT)


def _count(paths: Collection[Path]) -> str:
    return "1 file" if len(paths) == 1 else f"{len(paths)} files"


def _some(paths: list[Path]) -> str:
    return ", ".join(shown(p) for p in paths[:_SHOWN]) + (", …" if len(paths) > _SHOWN else "")
