"""A motion to be simulated, from a file with the same columns as a campaign's."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.advice import into_manifest, proposed_columns
from sysid.data.columns import Naming, listed
from sysid.data.conversion import in_si
from sysid.data.figures import figure
from sysid.data.manifest import Manifest
from sysid.data.readers import read_tables
from sysid.data.readers.base import Cells, RawTable
from sysid.data.steady import GAP_STEPS, gaps_in
from sysid.data.timebase import time_axis
from sysid.errors import DataError
from sysid.units import SI_SYMBOL

Samples = Float[np.ndarray, " n"]

_ACCELERATION: Final = re.compile(r"\s*acceleration(?:_(\S+)|\s*[\[(]([^\])]*)[\])])\s*", re.I)
_BAND: Final = 0.05
"""Of the range, about the middle: smaller ways through it are noise."""
_STILL: Final = 0.01
"""Of the range: where less than this is gone in a step, nothing moves."""
_FEW: Final = 0.05
"""Share of steps beyond which long ones are no gaps but how it was recorded."""
_QUANTITIES: Final = (
    "time", "displacement", "velocity", "acceleration", "current", "temperature",
)  # fmt: skip


@dataclass(frozen=True)
class MotionFile:
    """The columns of a motion file, SI.

    Attributes:
        time: [n] s, strictly increasing.
        displacement: [n] m, in the file's own coordinate.
        velocity: [n] m/s, if recorded.
        acceleration: [n] m/s², if recorded.
        current: [n] A, if recorded.
        temperature: [n] °C, if recorded.
        notes: What was done to the numbers, one sentence each.
    """

    time: Samples
    displacement: Samples
    velocity: Samples | None
    acceleration: Samples | None
    current: Samples | None
    temperature: Samples | None
    notes: tuple[str, ...]


def read_motion(path: Path, manifest: Manifest | None = None) -> MotionFile:
    """Read a motion.

    A temperature column without any number counts as not recorded.

    Args:
        path: A file in any format that campaigns may have; columns are recognised by quantity and
            unit (``time_s``, ``displacement_mm``, …).
        manifest: Names the columns otherwise, and may say the text's encoding and that extension
            is positive.

    Raises:
        DataError: The file cannot be read, holds more than one table, lacks time or displacement,
            or holds something that is no number.
        UnitError: A unit is not known.
    """
    manifest = manifest or Manifest()
    naming = manifest.naming()
    table = _table(path, naming, manifest.files.encoding)
    missing = [role for role in ("time", "displacement") if role not in table.columns]
    if missing:
        have = [column.header for column in table.columns.values()]
        lines = proposed_columns(table.unread, missing)
        raise DataError(
            f"has no column for {' and '.join(missing)}",
            where=path,
            advice=f"Its columns are: {listed([*have, *table.unread])}. Name them like time_s, "
            "displacement_mm, current_A, or give a --manifest and "
            + into_manifest("columns", *lines, has=bool(naming.named)),
        )
    notes = [*table.notes, *table.beside, *table.changes]
    values: dict[str, Samples] = {}
    for role in _QUANTITIES:
        column = table.columns.get(role)
        if column is None or (role == "temperature" and _silent(column.cells)):
            continue
        if column.unit is None:
            raise DataError(
                f"no unit is given for {role}",
                where=f"{path}, column {column.header!r}",
                advice=f"Write it into the header, for example {role}_{SI_SYMBOL[role]}",
            )
        values[role] = in_si(role, column, table, str(path), notes)
    if values["time"].size < 2:
        raise DataError("holds fewer than two rows of data", where=path, advice="Give a motion")
    time, keep, said = time_axis(values.pop("time"), table, str(path))
    notes += [*said, *(f"column {header!r} was not read" for header in table.unread)]
    kept = {role: array[keep] for role, array in values.items()}
    notes += _gaps_told(time, kept["displacement"])
    if manifest.campaign.positive_displacement == "extension":
        for role in ("displacement", "velocity", "acceleration"):
            if role in kept:
                kept[role] = -kept[role]
        notes.append("sign of the motion turned: the manifest says extension is positive")
    return MotionFile(
        time=time,
        displacement=kept["displacement"],
        velocity=kept.get("velocity"),
        acceleration=kept.get("acceleration"),
        current=kept.get("current"),
        temperature=kept.get("temperature"),
        notes=tuple(notes),
    )


def _silent(cells: Cells) -> bool:
    return cells.dtype.kind == "f" and not np.isfinite(cells.astype(np.float64)).any()


def _gaps_told(time: Samples, x: Samples) -> list[str]:
    """A sentence on gaps in time, by the mean rate at which the motion crosses its middle.

    A step as those beside it is a lower rate of recording, and none in which nothing moves hides
    anything.
    """
    step = np.diff(time)
    gaps = gaps_in(time, _crossings(x) / float(time[-1] - time[0]))
    gaps = np.array([k for k in gaps if _stands_out(step, k) and _moves(step, x, k)], dtype=int)
    if not gaps.size or gaps.size > _FEW * step.size:
        return []
    widest = int(gaps[np.argmax(step[gaps])])
    count = "a gap" if gaps.size == 1 else f"{gaps.size} gaps"
    return [
        f"time has {count}, of up to {figure(step[widest])} s behind {figure(time[widest])} s, "
        f"where steps of {figure(float(np.median(step)))} s are usual: what the motion was there "
        "is not known, and the force beside it is not the damper's. Simulate the parts by "
        "themselves"
    ]


def _crossings(x: Samples) -> float:
    """Cycles of a motion by its ways through the middle, beyond noise there; one at least."""
    reach = np.ptp(x)
    away = x - 0.5 * (x.min() + x.max())
    side = np.sign(away)[np.abs(away) > _BAND * reach]
    return max(0.5 * float(np.count_nonzero(np.diff(side))), 1.0)


def _stands_out(step: Samples, k: int) -> bool:
    """Whether a step is longer than those about it."""
    about = step[max(k - 2, 0) : k + 3]
    return bool(step[k] > GAP_STEPS * np.median(about))


def _moves(step: Samples, x: Samples, k: int) -> bool:
    """Whether the motion goes on in a step, by its ends and by the speeds before and behind."""
    moved = np.abs(np.diff(x))
    beside = [i for i in (k - 1, k + 1) if 0 <= i < step.size]
    ways = [moved[k], *(moved[i] / step[i] * step[k] for i in beside)]
    return bool(max(ways) > _STILL * np.ptp(x))


def _table(path: Path, naming: Naming, encoding: str | None) -> RawTable:
    try:
        data = path.read_bytes()
    except OSError as cause:
        raise DataError(
            f"cannot be read: {cause.strerror or cause}",
            where=path,
            advice="Give the path of a motion file that can be read",
        ) from cause
    tables = read_tables(data, path, naming, encoding)
    for header in tables[0].unread if tables else ():
        match = _ACCELERATION.fullmatch(header)
        if match:
            named = {**naming.named, "acceleration": (header, match[1] or match[2])}
            tables = read_tables(data, path, Naming(named), encoding)
    if len(tables) != 1:
        raise DataError(
            f"holds {len(tables)} tables or blocks; a motion is one",
            where=path,
            advice="Give a file with one table",
        )
    return tables[0]
