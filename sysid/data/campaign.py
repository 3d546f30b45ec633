"""A folder of measured tests → a `Campaign` of records in SI."""

import hashlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from sysid.data.conditions import KINDS, merge_conditions
from sysid.data.conversion import Origin, make_record
from sysid.data.folder import Place, find_place
from sysid.data.heating import cut_by_temperature
from sysid.data.listing import Listing, looks_like_listing, of_another_name
from sysid.data.manifest import Manifest
from sysid.data.names import NamePattern, conditions_in_name
from sysid.data.parts import cut_tests
from sysid.data.pooled import pooled
from sysid.data.readers import read_tables
from sysid.data.record import Record
from sysid.errors import DataError, SysidError

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Campaign:
    """An ordered set of measured tests and their manifest.

    Attributes:
        name: From the manifest, else the folder's name.
        folder: Where the data files are.
        records: By run order where every test has one, else by file name.
        manifest: As read, or the defaults.
        notes: What the user should know about the reading, one sentence each.
        unread: Ids of files that cannot be read, and were to be excluded.
    """

    name: str
    folder: Path
    records: tuple[Record, ...]
    manifest: Manifest
    notes: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()

    def to_frame(self) -> "pd.DataFrame":
        """One row a test: id, file, conditions with units in the names, size, provenance."""
        import pandas as pd

        return pd.DataFrame([_row(record) for record in self.records])


def _row(record: Record) -> dict[str, object]:
    nominal, samples = record.nominal, len(record.time)
    duration = float(record.time[-1] - record.time[0])
    return {
        "id": record.id,
        "file": record.source.file,
        "part": record.source.part,
        "kind": nominal.kind,
        "run_order": nominal.run_order,
        "amplitude_m": nominal.amplitude,
        "frequency_Hz": nominal.frequency,
        "current_A": nominal.current,
        "voltage_V": nominal.voltage,
        "temperature_degC": nominal.temperature,
        "temperature_sd_K": nominal.temperature_sd,
        "samples": samples,
        "duration_s": duration,
        "sampling_rate_Hz": (samples - 1) / duration,
        "sha256": record.source.sha256,
        "changes": "; ".join(record.source.changes),
    }


def load_campaign(
    folder: Path,
    manifest: Path | None = None,
    *,
    flip_force: bool = False,
    exclude: Sequence[str] = (),
) -> Campaign:
    """Read every test of a campaign.

    Args:
        folder: The campaign: a folder with data files, or with a ``campaign.toml`` that names it.
        manifest: A manifest elsewhere.  Then the data are those in `folder` if any there match
            the manifest's glob, else those in the folder that the manifest names.
        flip_force: Turn the force's sign in every test.
        exclude: Globs on ids; a file that matches one need not be readable.

    Raises:
        DataError: A data file cannot be read as what it claims to be; or there is none.
        ManifestError: ``campaign.toml`` or ``tests.csv`` is malformed or contradicts the files.
        UnitError: A unit is not known, or belongs to another quantity.
    """
    place = find_place(Path(folder), None if manifest is None else Path(manifest))
    notes = list(place.notes)
    besides: list[tuple[str, str]] = []
    remarks: list[tuple[str, str]] = []
    pattern = place.manifest.name_pattern()
    ids, unread = _ids(place), list[str]()
    records: list[Record] = []
    for path in place.files:
        try:
            found = _records_of(path, ids[path], place, flip_force, notes, besides)
        except SysidError as cause:
            if any(fnmatchcase(ids[path], glob) for glob in exclude):
                unread.append(ids[path])
                notes.append(f"{path} is excluded, and cannot be read: {cause.what}")
                continue
            if looks_like_listing(path):
                raise of_another_name(path, place.listing) from cause
            raise
        for record in found:
            told = _labels(record, path, place.listing, pattern, notes, remarks)
            if pattern is None:
                told.extend(_by_folders(record, told, remarks))
            nominal, contradictions = merge_conditions(record, told, place.manifest.constants)
            notes.extend(contradictions)
            records.append(replace(record, nominal=nominal))
    if place.listing is not None:
        notes.extend(_listed_parts_absent(place.listing, records))
    records = _by_temperature(records, place.manifest, notes)
    _need_unique(records, place)
    if all(record.nominal.run_order is not None for record in records):
        records.sort(key=lambda record: record.nominal.run_order or 0)
    name = place.manifest.campaign.name or place.folder.absolute().name or "campaign"
    notes = [*dict.fromkeys(notes), *pooled(besides, "files"), *pooled(remarks, "names")]
    return Campaign(name, place.folder, tuple(records), place.manifest, tuple(notes), tuple(unread))


def _by_temperature(records: list[Record], manifest: Manifest, notes: list[str]) -> list[Record]:
    """Tests recorded while the damper heats or cools, cut into parts."""
    step = manifest.sweeps.width()
    if step is None:
        return records
    out: list[Record] = []
    for record in records:
        parts, said = cut_by_temperature(record, step)
        out.extend(parts)
        if said is not None:
            notes.append(said)
    return out


def _ids(place: Place) -> dict[Path, str]:
    """Ids of files: their stems, with the folders where several files have one."""
    stems = Counter(path.stem for path in place.files)
    return {
        path: path.stem
        if stems[path.stem] == 1
        else path.relative_to(place.folder).with_name(path.stem).as_posix()
        for path in place.files
    }


def _records_of(
    path: Path,
    identity: str,
    place: Place,
    flip_force: bool,
    notes: list[str],
    besides: list[tuple[str, str]],
) -> list[Record]:
    """The tests of one file; what its columns repeat stands in `nominal` for the time being."""
    try:
        data = path.read_bytes()
    except OSError as cause:
        raise DataError(
            f"cannot be read: {cause.strerror or cause}",
            where=path,
            advice="Check the file and its permissions",
        ) from cause
    manifest = place.manifest
    tables = read_tables(data, path, manifest.naming(), manifest.files.encoding)
    relative = path.relative_to(place.folder).as_posix()
    for table in tables:
        notes.extend(table.notes)
        besides.extend((relative, sentence) for sentence in table.beside)
    origin = Origin(str(path), relative, identity, hashlib.sha256(data).hexdigest())
    records = []
    for test in cut_tests(tables, manifest.files.blocks, str(path)):
        record = make_record(
            test,
            origin,
            manifest.campaign,
            flip_force=flip_force,
            manifest_names="columns" in manifest.model_fields_set,
        )
        kind = test.told.get("kind")
        if kind is not None and kind not in KINDS:
            raise DataError(
                f"kind {kind!r} is not known", where=path, advice=f"Kinds: {', '.join(KINDS)}"
            )
        records.append(replace(record, nominal=replace(record.nominal, **test.told)))
    return records


def _labels(
    record: Record,
    path: Path,
    listing: Listing | None,
    pattern: NamePattern | None,
    notes: list[str],
    remarks: list[tuple[str, str]],
) -> list[tuple[str, dict[str, object]]]:
    """Who says what about a test, first of precedence first; `remarks` get what names do not."""
    columns = {
        name: value
        for name, value in vars(record.nominal).items()
        if value is not None and (name != "kind" or value != "sine")
    }
    told: list[tuple[str, dict[str, object]]] = [("the file's column", columns)]
    if listing is not None:
        told.append(("tests.csv", _listed(record, listing, notes)))
    if pattern is None:
        named, said = conditions_in_name(path.stem)
        remarks.extend((path.stem, sentence) for sentence in said)
    else:
        named = pattern.read(path.stem)
        if named is None:
            told_not = f"the name does not fit {pattern.text!r}; it tells nothing"
            remarks.append((record.source.file, told_not))
    values: dict[str, object] = dict(named or {})
    told.append(("the file name", values))
    return told


def _by_folders(
    record: Record,
    told: list[tuple[str, dict[str, object]]],
    remarks: list[tuple[str, str]],
) -> list[tuple[str, dict[str, object]]]:
    """What names of folders say, the nearest first; `remarks` get what only they say."""
    known = {condition for _, values in told for condition in values}
    found = []
    for folder in reversed(PurePosixPath(record.source.file).parts[:-1]):
        named, said = conditions_in_name(folder)
        remarks.extend((folder, sentence) for sentence in said)
        new = [condition for condition in named if condition not in known]
        if new:
            remarks.append((folder, f"the folder's name tells {' and '.join(new)}"))
            known.update(new)
        values: dict[str, object] = dict(named)
        found.append((f"the folder {folder!r}", values))
    return found


def _listed(record: Record, listing: Listing, notes: list[str]) -> dict[str, object]:
    file, part = record.source.file, record.source.part
    for name in (f"{file}#{part}", file) if part is not None else (file,):
        if name in listing.tests:
            return dict(listing.tests[name])
    notes.append(f"{file}: is not listed in {listing.path.name}")
    return {}


def _listed_parts_absent(listing: Listing, records: list[Record]) -> list[str]:
    parts = {f"{r.source.file}#{r.source.part}" for r in records} | {r.source.file for r in records}
    return [
        f"{listing.path.name}, line {listing.lines[name]}: {name!r} is no test that was read"
        for name in listing.tests
        if name not in parts
    ]


def _need_unique(records: list[Record], place: Place) -> None:
    seen: dict[str, str] = {}
    for record in records:
        if record.id in seen:
            raise DataError(
                f"two tests have the id {record.id!r}: {seen[record.id]} and {record.source.file}",
                where=place.folder,
                advice="Rename one of the files",
            )
        seen[record.id] = record.source.file
