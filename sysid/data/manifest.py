"""`campaign.toml`: what a campaign's files mean.  Unknown keys are refused.

The keys are those of the published contract, plus some that few files need: ``files.encoding``
(where the text is in none of the encodings that are recognised), ``files.blocks`` (what
several start/resume blocks in one text file are), ``sweeps`` (how tests are cut in which the
temperature moves) and ``tolerance`` (what the damper's drawing allows its peak forces to be).
"""

import difflib
import tomllib
from pathlib import Path
from typing import Any, Final, Literal

from pydantic import ValidationError

from sysid.data.advice import EXAMPLE_UNITS, column_line
from sysid.data.columns import WORDS, Naming, known_unit, parse_header, unit_quantity
from sysid.data.heating import STEP
from sysid.data.manifest_place import Key, key_name, place_of
from sysid.data.names import NamePattern, compile_pattern
from sysid.data.section import Amount, Section, Text, UncertainAmount
from sysid.data.tolerance import ToleranceSection, check_tolerance
from sysid.errors import ManifestError, SysidError
from sysid.units import find_unit

MANIFEST: Final = "campaign.toml"
"""Its name."""
Direction = Literal["compression", "extension"]


class CampaignSection(Section):
    """``[campaign]``: name, and what positive numbers in the files mean."""

    name: Text | None = None
    positive_force: Direction = "compression"
    positive_displacement: Direction = "compression"


class FilesSection(Section):
    """``[files]``: where the data are and what their names tell."""

    folder: Text = "."
    glob: Text = "*.csv"
    name: Text | None = None
    encoding: Text | None = None
    blocks: Literal["auto", "join", "separate"] = "auto"


class ColumnEntry(Section):
    """One column: its header, and the unit (None: the file's own word)."""

    column: Text
    unit: Text | None = None


class ColumnsSection(Section):
    """``[columns]``: columns that are not named by quantity and unit."""

    time: ColumnEntry | None = None
    displacement: ColumnEntry | None = None
    velocity: ColumnEntry | None = None
    force: ColumnEntry | None = None
    current: ColumnEntry | None = None
    voltage: ColumnEntry | None = None
    temperature: ColumnEntry | None = None
    amplitude: ColumnEntry | None = None
    frequency: ColumnEntry | None = None
    test: ColumnEntry | None = None


class ConstantsSection(Section):
    """``[constants]``: conditions that hold for every test that does not say otherwise."""

    amplitude: Amount | None = None
    frequency: Amount | None = None
    current: Amount | None = None
    voltage: Amount | None = None
    temperature: UncertainAmount | None = None


class LimitsSection(Section):
    """``[limits]``: what rig and damper can do, for test recommendations."""

    stroke: Amount | None = None
    velocity: Amount | None = None
    current: Amount | None = None
    force: Amount | None = None
    frequency: Amount | None = None


class SweepsSection(Section):
    """``[sweeps]``: what becomes of tests in which the temperature moves (`heating`)."""

    cut: bool = True
    step: Amount | None = None

    def width(self) -> float | None:
        """K by which it may move in a test that stays whole; None for any."""
        if not self.cut:
            return None
        if self.step is None:
            return STEP
        return self.step.value * find_unit(self.step.unit, "temperature").factor


class Manifest(Section):
    """A campaign's manifest; every default is the reading of a folder without one."""

    campaign: CampaignSection = CampaignSection()
    files: FilesSection = FilesSection()
    columns: ColumnsSection = ColumnsSection()
    constants: ConstantsSection = ConstantsSection()
    limits: LimitsSection = LimitsSection()
    sweeps: SweepsSection = SweepsSection()
    tolerance: ToleranceSection = ToleranceSection()

    def naming(self) -> Naming:
        """How the columns are named."""
        entries = ((role, getattr(self.columns, role)) for role in type(self.columns).model_fields)
        return Naming({r: (e.column.strip(), e.unit) for r, e in entries if e is not None})

    def name_pattern(self) -> NamePattern | None:
        """The pattern of the files' names, if there is one."""
        return None if self.files.name is None else compile_pattern(self.files.name)


_LIMIT_QUANTITIES: Final[dict[str, str]] = {"stroke": "displacement"}


def read_manifest(path: Path) -> Manifest:
    """Read and check a manifest.

    Raises:
        ManifestError: The file cannot be read, is no TOML, or says something that is not known;
            the message names file, key and line.
    """
    text = _text(path)
    try:
        raw = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as cause:
        raise ManifestError(
            f"is not valid TOML: {cause}", where=path, advice="Correct the syntax there"
        ) from cause
    try:
        manifest = Manifest.model_validate(raw)
    except ValidationError as cause:
        raise _refusal(path, text, cause) from cause
    _check_meaning(manifest, path, text)
    return manifest


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as cause:
        raise ManifestError(
            "is not UTF-8 text", where=path, advice="Save the manifest as UTF-8"
        ) from cause
    except OSError as cause:
        raise ManifestError(
            f"the manifest cannot be read: {cause.strerror or cause}",
            where=path,
            advice="Give the path of a campaign.toml that can be read",
        ) from cause


def _refusal(path: Path, text: str, cause: ValidationError) -> ManifestError:
    """The first complaint of pydantic as a sentence for an engineer.

    A key that is not known comes before all others: misspelt, it is also one that is missing.
    """
    found = cause.errors()
    unknown = (c for c in found if c["type"] == "extra_forbidden")
    complaint = next(unknown, found[0])
    place = complaint["loc"]
    where, key = place_of(path, text, place), key_name(place)
    advice = None
    if complaint["type"] == "extra_forbidden":
        what = f"key {key!r} is not known"
        advice = _known_keys(place)
    elif complaint["type"] == "missing":
        what = f"key {key!r} is missing"
        advice = f"Add `{place[-1]} = …` there"
    else:
        said = complaint["msg"].removeprefix("Value error, ")
        shown = repr(complaint["input"])[:60]
        what = f"{key} = {shown} is refused: {said[:1].lower()}{said[1:]}"
    return ManifestError(what, where=where, advice=advice)


def _known_keys(place: Key) -> str:
    model: Any = Manifest
    for part in (z for z in place[:-1] if isinstance(z, str)):
        model = _model_of(model.model_fields[part].annotation)
    known = list(model.model_fields)
    near = difflib.get_close_matches(str(place[-1]), known, n=1)
    meant = f"Did you mean {near[0]!r}? " if near else ""
    return f"{meant}Known keys here: {', '.join(known)}"


def _model_of(annotation: Any) -> Any:
    """The table behind an optional one, or behind a list of them."""
    options = getattr(annotation, "__args__", (annotation,))
    return next(option for option in options if isinstance(option, type(Section)))


def _need_own_column(role: str, column: str, unit: str | None, where: str) -> None:
    """Refuse a header that says another quantity with its unit, where nothing says that it errs."""
    if role in WORDS:  # a key of tests may be any column
        return
    header = parse_header(column)
    if header is None or header.unit is None or unit is not None:
        return
    quantity = unit_quantity(header.role)
    if known_unit(header.unit, quantity) and quantity != unit_quantity(role):
        raise ManifestError(
            f"column {column!r} is named as {role}, and its header says {header.role}",
            where=where,
            advice=f"Give the header of the column that holds {role}; if it is this one, say its "
            "unit, too: " + column_line(role, column, EXAMPLE_UNITS.get(role, "…")),
        )


def _check_meaning(manifest: Manifest, path: Path, text: str) -> None:
    """Units, name pattern and columns that contradict each other."""
    seen: dict[str, str] = {}
    for role, (column, unit) in manifest.naming().named.items():
        key = ["columns", role]
        if column in seen:
            raise ManifestError(
                f"column {column!r} is named as {seen[column]} and as {role}",
                where=place_of(path, text, key),
            )
        seen[column] = role
        _need_own_column(role, column, unit, place_of(path, text, key))
        if unit is not None and role in WORDS:
            raise ManifestError(f"{role} has no unit", where=place_of(path, text, key))
        if unit is not None:
            find_unit(unit, unit_quantity(role), where=place_of(path, text, key))
    for section in (manifest.constants, manifest.limits):
        name = "constants" if section is manifest.constants else "limits"
        for key in type(section).model_fields:
            amount: Amount | None = getattr(section, key)
            if amount is None:
                continue
            place = place_of(path, text, [name, key])
            find_unit(amount.unit, _LIMIT_QUANTITIES.get(key, unit_quantity(key)), where=place)
            if amount.value <= 0 and (name == "limits" or key in ("amplitude", "frequency")):
                raise ManifestError(f"{name}.{key} must be positive", where=place)
    if manifest.sweeps.step is not None:
        place = place_of(path, text, ["sweeps", "step"])
        find_unit(manifest.sweeps.step.unit, "temperature", where=place)
        if manifest.sweeps.step.value <= 0:
            raise ManifestError("sweeps.step must be positive", where=place)
    check_tolerance(manifest.tolerance, lambda key: place_of(path, text, key))
    try:
        manifest.name_pattern()
    except SysidError as cause:
        raise ManifestError(
            cause.what, where=place_of(path, text, ["files", "name"]), advice=cause.advice
        ) from cause
