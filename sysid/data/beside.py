"""What lies beside the files of a campaign: nothing that could be read is left out unsaid."""

import fnmatch
import os
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sysid.data.glance import first_lines, holds_numbers
from sysid.data.listing import LISTING, looks_like_listing
from sysid.data.manifest import MANIFEST, Manifest
from sysid.data.readers import find_reader
from sysid.data.readers.text import TEXT
from sysid.errors import DataError

_ABOUT: Final = ("readme", "license", "licence", "changelog")
"""How names of texts begin that hold no test."""
_PROSE: Final = (".txt", ".dat", ".asc")
"""Endings under which there may be words alone."""
_RESULTS: Final = ("fit.json", "card.json", "check.json", "diagnosis.json", "fleet.jsonl")
"""What this program writes: tables beside it are results, too."""
_SECTION: Final = re.compile(rf"\s*(?:\[\s*)?(?:{'|'.join(Manifest.model_fields)})\s*[\].]")
"""A line of a manifest."""
_SHOWN: Final = 3
_LOOKED: Final = 30
"""Files of a folder that are opened to see what they are; more are counted as they are named."""
_COUNTED: Final = 1000
"""Files in sub-folders that are counted."""


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
    readable, others, folders = [], [], []
    for entry in _entries(folder):
        path = folder / entry.name
        if _is(entry.is_dir):
            folders.append(path)
        elif _is(entry.is_file):
            (readable if find_reader(path) else others).append(path)
    return Beside(tuple(sorted(readable)), tuple(sorted(others)), tuple(sorted(folders)))


def _entries(folder: Path) -> Iterator["os.DirEntry[str]"]:
    """One by one what is in a folder and neither hidden nor manifest or list of tests."""
    try:
        with os.scandir(folder) as found:
            for entry in found:
                if entry.name.lower() not in (LISTING, MANIFEST) and not _hidden(entry.name):
                    yield entry
    except OSError:
        return


def _is(kind: Callable[[], bool]) -> bool:
    try:
        return kind()
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
    return _hidden(path.name)


def _hidden(name: str) -> bool:
    return name.startswith((".", "~$"))


def unread(
    folder: Path,
    glob: str,
    files: Collection[Path],
    *,
    below: bool = True,
    listing: Path | None = None,
) -> list[str]:
    """Sentences on files in a folder and in its sub-folders that could be read and are not.

    Args:
        folder: Where the data are.
        glob: Of the files that are read.
        files: Those that are read, or told of otherwise.
        below: Look into sub-folders, too, one level down.
        listing: The list of tests that is read.
    """
    there = beside(folder)
    taken = set(files)
    told = []
    left, lists = _sorted_out([p for p in there.readable if p not in taken])
    told.extend(
        f"{shown(p)} in {folder} lists tests and is not read under this name: what it says of them "
        f"is not known. Rename it to {LISTING}, or move it elsewhere"
        if listing is None
        else f"{shown(p)} in {folder} is a second list of tests and is not read; {listing} is. "
        "What it says alone, write there, and move it elsewhere"
        for p in lists
    )
    if left:
        told.append(
            f"{_count(left)} in {folder} {'is' if len(left) == 1 else 'are'} not read, since "
            f"{glob!r} does not match: {_some(left)}. Where they are tests, too, change `glob` "
            f"under [files] in {MANIFEST}, or give them a folder of their own"
        )
    if below:
        told.extend(_below(folder, there.folders, taken))
    return told


def _below(folder: Path, folders: Sequence[Path], taken: Collection[Path]) -> list[str]:
    """A sentence on files in sub-folders, if there are any."""
    found: list[Path] = []
    for place in folders:
        found += _in_folder(place, taken, _COUNTED + 1 - len(found))
        if len(found) > _COUNTED:
            break
    tests, lists = _sorted_out(found)
    left = tests + lists
    if not left:
        return []
    said = f"more than {_COUNTED} files" if len(found) > _COUNTED else _count(left)
    inside = [place for place in folders if place in {path.parent for path in left}]
    return [
        f"{said} in sub-folders of {folder} {'is' if said == '1 file' else 'are'} not read "
        f"({_some(inside)}). Where they are tests of another damper, read that folder by itself; "
        "where of the same one, put all into one folder, or change `glob` under [files] in "
        f"{MANIFEST}"
    ]


def _in_folder(folder: Path, taken: Collection[Path], most: int) -> list[Path]:
    """Files of a sub-folder in a format that is read, `most` at most; none beside results."""
    found: list[Path] = []
    for entry in _entries(folder):
        if entry.name in _RESULTS:
            return []
        path = folder / entry.name
        if find_reader(path) and path not in taken and _is(entry.is_file):
            found.append(path)
            if len(found) == most:
                break
    return sorted(found)


def _sorted_out(files: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """What may be tests, and lists of tests; only so many of the files are looked into."""
    tests: list[Path] = []
    lists: list[Path] = []
    looked = 0
    for path in files:
        if _about(path):
            continue
        suffix = path.suffix.lower()
        if suffix in TEXT.suffixes and looked < _LOOKED:
            looked += 1
            if looks_like_listing(path):
                lists.append(path)
                continue
            if suffix in _PROSE and not holds_numbers(path):
                continue
        tests.append(path)
    return tests, lists


def loose(fleet: Path) -> list[str]:
    """A sentence on files that lie beside the sub-folders of a fleet, if there are any.

    Args:
        fleet: Folder of campaigns.
    """
    tests, lists = _sorted_out(beside(fleet).readable)
    left = sorted(tests + lists)
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
            if name.lower().endswith(".toml")
            and not name.startswith(".")
            and any(_SECTION.match(line) for line in first_lines(folder / name))
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
