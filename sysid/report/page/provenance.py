"""Where every number on the page comes from: files, versions, seed, command."""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Final

from sysid import __version__
from sysid.cards.schema import Card, Validity
from sysid.data.record import Record
from sysid.data.tolerance import Tolerance

PACKAGES: Final = ("numpy", "scipy", "jax", "jaxlib", "equinox", "optimistix", "plotly", "jinja2")
"""Whose versions may change a number or the page."""


@dataclass(frozen=True)
class FileRow:
    """One measured file.

    Attributes:
        file: Relative to the campaign's folder.
        sha256: Of the whole file.
        changes: What was done to its numbers on the way in.
    """

    file: str
    sha256: str
    changes: str


@dataclass(frozen=True)
class Provenance:
    """How the page came about.

    Attributes:
        campaign: Its name.
        command: As it was typed; empty where there was none.
        seed: Of everything random; None where nothing is.
        software: (name, version).
        settings: (name, value): model, weights and the like.
        files: All measured files.
        box: (quantity, range) that the card holds for.
        left_out: (test, reason).
        notes: What was done on the way.
    """

    campaign: str
    command: str
    seed: int | None
    software: tuple[tuple[str, str], ...]
    settings: tuple[tuple[str, str], ...]
    files: tuple[FileRow, ...]
    box: tuple[tuple[str, str], ...]
    left_out: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Origin:
    """What the caller knows of the run.

    Attributes:
        campaign: Name of the campaign.
        records: Its tests.
        command: As it was typed.
        folder: Of the campaign, as it was typed.
        output: Folder of the results, as it was typed.
        seed: Of everything random; None where nothing is.
        left_out: Test → reason.
        notes: On the reading.
        tolerance: What the damper's drawing allows; None where nobody said.
    """

    campaign: str
    records: Sequence[Record]
    command: str = ""
    folder: str = "CAMPAIGN"
    output: str = "DIR"
    seed: int | None = None
    left_out: Mapping[str, str] | None = None
    notes: tuple[str, ...] = ()
    tolerance: Tolerance | None = None


def provenance(
    origin: Origin, settings: Mapping[str, str], card: Card | None, notes: Sequence[str] = ()
) -> Provenance:
    """Gather it.

    Args:
        origin: What the caller knows.
        settings: Name → value.
        card: Whose validity is told; None for several cards.
        notes: Of the result, beside those on the reading.
    """
    rows: dict[str, FileRow] = {}
    for record in origin.records:
        source = record.source
        rows.setdefault(source.file, FileRow(source.file, source.sha256, "; ".join(source.changes)))
    return Provenance(
        campaign=origin.campaign,
        command=origin.command,
        seed=origin.seed,
        software=software(),
        settings=tuple(settings.items()),
        files=tuple(rows.values()),
        box=() if card is None else box_of(card.validity),
        left_out=tuple((origin.left_out or {}).items()),
        notes=tuple(dict.fromkeys((*origin.notes, *notes))),
    )


def software() -> tuple[tuple[str, str], ...]:
    """Versions of this program and of what it computes with."""
    found = [("sysid", __version__), ("Python", platform.python_version())]
    for name in PACKAGES:
        try:
            found.append((name, version(name)))
        except PackageNotFoundError:
            continue
    return tuple(found)


def box_of(validity: Validity) -> tuple[tuple[str, str], ...]:
    """Ranges that were fitted, in the units of the page."""
    told = (
        ("amplitude", validity.amplitude, 1e3, "mm"), ("frequency", validity.frequency, 1.0, "Hz"),
        ("velocity", validity.velocity, 1.0, "m/s"), ("current", validity.current, 1.0, "A"),
        ("temperature", validity.temperature, 1.0, "°C"),
    )  # fmt: skip
    return tuple(
        (name, f"{_end(scale * ends[0])} … {_end(scale * ends[1])} {unit}")
        for name, ends, scale, unit in told
        if ends is not None
    )


def _end(value: float) -> str:
    """Three digits without zeros behind; a measured zero is one."""
    return f"{round(value, 4) + 0.0:.3g}".replace("-", "−")
