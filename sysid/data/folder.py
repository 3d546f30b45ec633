"""Which folder, which manifest, which files: what makes up a campaign before anything is read."""

import os
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sysid.data.advice import into_manifest, quoted
from sysid.data.beside import beside, hidden, matches, misnamed, unread
from sysid.data.listing import LISTING, Listing, read_listing
from sysid.data.manifest import MANIFEST, Manifest, read_manifest
from sysid.errors import DataError, ManifestError


@dataclass(frozen=True)
class Place:
    """The files of a campaign.

    Attributes:
        folder: Where the data are.
        files: Data files, by name.
        manifest: As read, or the defaults.
        listing: `tests.csv`, if there is one.
        notes: What the user should know.
    """

    folder: Path
    files: tuple[Path, ...]
    manifest: Manifest
    listing: Listing | None
    notes: tuple[str, ...]


def find_place(folder: Path, manifest_path: Path | None) -> Place:
    """Settle where a campaign's data are.

    With a manifest of its own, the folder that it names counts.  With a manifest given apart, the
    campaign's folder counts if files there match the manifest's glob, else the folder that the
    manifest names.

    Raises:
        ManifestError: The manifest or `tests.csv` is malformed, or lists a file that is absent.
        DataError: There is no such folder, or no data file in it.
    """
    _need_folder(folder)
    notes: list[str] = []
    own = folder / MANIFEST
    if manifest_path is None:
        _need_spelling(folder, MANIFEST)
        manifest = read_manifest(own) if os.path.lexists(own) else Manifest()
        data = folder / manifest.files.folder
        manifest_path = own
    else:
        manifest = read_manifest(manifest_path)
        if os.path.lexists(own) and not _same_file(own, manifest_path):
            notes.append(f"{own} is not used, because --manifest names {manifest_path}")
        data = manifest_path.parent / manifest.files.folder
        if matches(folder, manifest.files.glob):
            elsewhere = data.is_dir() and not _same_file(folder, data)
            if elsewhere and matches(data, manifest.files.glob):
                notes.append(f"the data in {folder} are read, not those in {data}")
            data = folder
    _need_folder(data, f"{manifest_path}, files.folder")
    matched = matches(data, manifest.files.glob)
    listing = _find_listing(data, manifest_path.parent)
    files = tuple(path for path in matched if not hidden(path))
    notes.extend(f"{path} is a hidden file and was not read" for path in matched if hidden(path))
    if listing is not None:
        notes.extend(listing.notes)
        notes.extend(_check_listed(listing, data, files, manifest.files.glob))
    if not files:
        raise _nothing(data, manifest, manifest_path)
    for path in files:
        _need_file(path)
    glob, known = manifest.files.glob, {*matched, *_listed(listing, data)}
    own_list = None if listing is None else listing.path
    notes.extend(unread(data, glob, known, listing=own_list))
    if not _same_file(data, folder):
        notes.extend(unread(folder, glob, known, below=False, listing=own_list))
    notes.extend(misnamed(data, has=os.path.lexists(manifest_path)))
    return Place(data, files, manifest, listing, tuple(notes))


def _need_folder(folder: Path, named_by: str | None = None) -> None:
    where = folder if named_by is None else f"{named_by} = {folder}"
    try:
        mode = folder.stat().st_mode
    except (OSError, ValueError) as cause:
        why = getattr(cause, "strerror", None) or str(cause)
        raise DataError(
            f"the campaign's folder cannot be opened: {why}",
            where=where,
            advice="Give the folder that holds the data files",
        ) from cause
    if not stat.S_ISDIR(mode):
        raise DataError(
            "is a file, not a folder", where=where, advice="Give the folder that holds the files"
        )


def _need_spelling(folder: Path, name: str) -> None:
    """Refuse a manifest or listing under a name by which it would not be read."""
    if os.path.lexists(folder / name):
        return
    try:
        there = sorted(path.name for path in folder.iterdir())
    except OSError:  # told where the data are listed
        return
    alike = [z for z in there if z.lower() in (name, f"{name}.txt")]
    if alike:
        raise ManifestError(
            "is not read under this name",
            where=folder / alike[0],
            advice=f"Rename it to {name}, or to something else if it is not meant",
        )


def _need_file(path: Path) -> None:
    """A regular file that can be looked at, with a name that can be shown."""
    try:
        path.name.encode("utf-8")
    except UnicodeEncodeError as cause:
        shown = os.fsencode(path).decode("utf-8", "backslashreplace")
        raise DataError("the file's name is not valid text", where=shown, advice="Rename it") \
            from cause  # fmt: skip
    try:
        mode = path.stat().st_mode
    except OSError as cause:
        raise DataError(
            f"cannot be read: {cause.strerror or cause}",
            where=path,
            advice="Remove the link, or make it lead to a data file",
        ) from cause
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "no regular file"
        raise DataError(
            f"is {kind}, though its name is that of a data file",
            where=path,
            advice="Rename it, or narrow `glob` in campaign.toml",
        )


def _find_listing(data: Path, beside: Path) -> Listing | None:
    for folder in (data, beside):
        _need_spelling(folder, LISTING)
        path = folder / LISTING
        if os.path.lexists(path):
            return read_listing(path)
    return None


def _listed(listing: Listing | None, data: Path) -> list[Path]:
    """The files that `tests.csv` lists: those that are not read are told of by their lines."""
    names = () if listing is None else listing.tests
    return [data / file for name in names for file in (name, name.rpartition("#")[0]) if file]


def _check_listed(listing: Listing, data: Path, files: tuple[Path, ...], glob: str) -> list[str]:
    known = {path.relative_to(data).as_posix() for path in files}
    notes = []
    for name in listing.tests:
        file = name if name in known else name.rpartition("#")[0] or name
        if file in known:
            continue
        if not os.path.lexists(data / file):
            raise ManifestError(
                f"lists {file!r}, which is not in {data}",
                where=f"{listing.path}, line {listing.lines[name]}",
                advice="Correct the name (with its ending), add the file, or remove the line",
            )
        notes.append(f"{listing.path.name} lists {file!r}, which {glob!r} does not match: not read")
    return notes


def _nothing(folder: Path, manifest: Manifest, path: Path) -> DataError:
    """No file matches: what is there instead, and how to have it read."""
    glob, has = manifest.files.glob, "files" in manifest.model_fields_set
    there = beside(folder)
    readable = _endings(there.readable)
    if readable:
        lines = f"glob = {quoted(f'*{readable[0]}')}"
        told = into_manifest("files", lines, path=path, has=has)
        return DataError(
            f"no file matches {glob!r}, but there are {', '.join(readable)} files",
            where=folder,
            advice=f"{told[:1].upper()}{told[1:]}",
        )
    below = [p for p in there.folders if matches(p, glob)] if "/" not in glob else []
    if below:
        told = into_manifest("files", f"glob = {quoted(f'*/{glob}')}", path=path, has=has)
        return DataError(
            f"no file matches {glob!r}, but files in its sub-folders do ({below[0].name}, …)",
            where=folder,
            advice=f"Give one of the sub-folders; or, if all of them are one damper, {told}",
        )
    if there.others:
        return DataError(
            f"no file matches {glob!r}; its {', '.join(_endings(there.others))} files are of no "
            "format that is read",
            where=folder,
            advice="Export the tests as .csv, .xlsx, .mat, .tdms or .parquet",
        )
    return DataError(
        f"holds no data file (nothing matches {glob!r})",
        where=folder,
        advice="Give the folder that holds the measured files",
    )


def _endings(files: Sequence[Path]) -> list[str]:
    """Endings of files, most frequent first."""
    found = [p.suffix.lower() or p.name for p in files]
    return sorted(set(found), key=lambda ending: (-found.count(ending), ending))[:6]


def _same_file(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except OSError:
        return False
