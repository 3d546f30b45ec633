"""LabVIEW TDMS by nptdms; every group with channels for a test is a table."""

import io
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import numpy as np

from sysid.data.columns import REQUIRED, Naming, listed
from sysid.data.readers.base import (
    FEWEST_ROWS,
    RawTable,
    Reader,
    guarded,
    only_tests,
    with_beside,
)
from sysid.data.readers.tree import Tree, table_from_columns
from sysid.errors import DataError

_MADE_TIME: Final = "time_s"


def read_tdms(
    data: bytes, path: Path, naming: Naming, encoding: str | None = None
) -> tuple[RawTable, ...]:
    """Read a TDMS file.

    Units come from the channel's name or its ``unit_string``.  A group without a time channel
    gets its time from the waveform's ``wf_increment``.

    Raises:
        DataError: The file is damaged, or no group holds a test.
    """
    del encoding
    if not data:
        raise DataError("is empty", where=path, advice="Export the file again, or remove it")
    groups = _groups(data, path)
    found = [
        (name, channels)
        for name, channels in groups
        if len(naming.recognised([c.name for c in channels]) & set(REQUIRED)) >= 2
    ]
    partial = {name for name, _ in found}
    if not found:
        names = [f"{group}/{c.name}" for group, channels in groups for c in channels]
        raise DataError(
            "no group has channels for time, displacement and force",
            where=path,
            advice=f"It holds {listed(names)}. Name channels like displacement_mm, force_N, or "
            "name them in campaign.toml under [columns]",
        )
    found = only_tests(
        found,
        lambda group: {"time", *naming.recognised([c.name for c in group[1]])},  # or it is made
        lambda group: any(not naming.recognised([c.name]) for c in _longest(group[1])),
    )
    alone = len(found) == 1
    tables = [_table(None if alone else name, channels, naming, path) for name, channels in found]
    kept = {name for name, _ in found}
    told = [
        f"group {name} is not read: of {listed([c.name for c in channels])}, not all of "
        "time, displacement and force are named. If it is a test, name its channels so, or name "
        "them in campaign.toml under [columns]"
        for name, channels in groups
        if name not in kept and (name in partial or _like_a_test(channels))
    ]
    return with_beside(tables, told)


def _longest(channels: list["_Channel"]) -> list["_Channel"]:
    """Channels of numbers as long as the longest, if they are long enough to be a recording."""
    found = [c for c in channels if c.values.dtype.kind in "fiuM"]
    longest = max((len(c.values) for c in found), default=0)
    return [c for c in found if len(c.values) == longest >= FEWEST_ROWS]


def _like_a_test(channels: list["_Channel"]) -> bool:
    """Whether a group without a name that is known may be a test, its time made or a channel."""
    made = any(channel.increment is not None for channel in channels)
    return len(_longest(channels)) + made >= len(REQUIRED)


class _Channel:
    """Name, unit, values and increment of a channel."""

    def __init__(self, channel: Any) -> None:
        self.name = str(channel.name)
        self.unit = str(channel.properties.get("unit_string") or "").strip()
        self.increment = channel.properties.get("wf_increment")
        self.values = np.asarray(channel[:])


def _groups(data: bytes, path: Path) -> list[tuple[str, list[_Channel]]]:
    with guarded(path, "TDMS"):
        from nptdms import TdmsFile

        with _warnings_of("nptdms") as warned:
            file = TdmsFile.read(io.BytesIO(data))
            groups = [(g.name, [_Channel(c) for c in g.channels()]) for g in file.groups()]
        if file.file_status.incomplete_final_segment:
            raise DataError(
                "is cut short: its last segment is incomplete",
                where=path,
                advice="Copy or record the file again",
            )
        if warned:
            raise DataError(
                f"is damaged or cut short: {warned[0]}",
                where=path,
                advice="Copy or record the file again",
            )
        return groups


class _Collector(logging.Handler):
    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.said: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep one message."""
        self.said.append(" ".join(record.getMessage().split())[:160])


@contextmanager
def _warnings_of(library: str) -> Iterator[list[str]]:
    """What a library would write to the console about a file, caught."""
    collector = _Collector()
    loggers = [
        logger
        for name, logger in logging.root.manager.loggerDict.items()
        if name.startswith(f"{library}.") and isinstance(logger, logging.Logger)
    ]
    kept = [(logger, logger.handlers, logger.propagate) for logger in loggers]
    for logger in loggers:
        logger.handlers, logger.propagate = [collector], False
    try:
        yield collector.said
    finally:
        for logger, handlers, propagate in kept:
            logger.handlers, logger.propagate = handlers, propagate


def _table(part: str | None, channels: list[_Channel], naming: Naming, path: Path) -> RawTable:
    fields: dict[str, Tree] = {channel.name: channel.values for channel in channels}
    units = {channel.name: channel.unit for channel in channels if channel.unit}
    changes: list[str] = []
    if "time" not in naming.recognised(list(fields)) and "time" not in naming.named:
        fields[_MADE_TIME] = _made_time(channels, path)
        changes.append("time was made from the channels' wf_increment")
    for name, values in fields.items():
        if isinstance(values, np.ndarray) and values.dtype.kind == "M" and len(values):
            fields[name] = (values - values[0]) / np.timedelta64(1, "s")
            units.setdefault(name, "s")
            changes.append(f"time stamps of {name!r} were made seconds since the first")
    return table_from_columns(fields, naming, path, part, units, changes)


def _made_time(channels: list[_Channel], path: Path) -> np.ndarray:
    steps = {channel.increment for channel in channels if channel.increment is not None}
    if len(steps) != 1:
        raise DataError(
            "has no time channel, and no single wf_increment from which time could be made",
            where=path,
            advice="Add a channel time_s",
        )
    step = float(steps.pop())
    if not step > 0:
        raise DataError(f"wf_increment is {step:g} s, which is no time step", where=path)
    return np.arange(max(len(channel.values) for channel in channels)) * step


TDMS: Final = Reader("TDMS", (".tdms",), read_tdms)
