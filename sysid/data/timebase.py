"""Time stamps → a strictly increasing time axis, or a refusal.

Time that goes backwards is refused.  Stamps that repeat because they were written with too few
digits are replaced by the even sampling that they were rounded from; a stamp that repeats here and
there loses its second row.  Both are said, in sentences that begin with `TIME_CHANGE`.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from sysid.data.readers.base import RawTable
from sysid.errors import DataError

TIME_CHANGE: Final = "time stamps"
"""How a sentence of `Source.changes` about repeated time stamps begins."""

_ROUNDED_SHARE: Final = 0.1
"""Stamps are taken for rounded where at least this share of them repeats the one before."""

_MOST_REPEATED: Final = 0.5
"""More repeats than this, and not from rounding: no time axis can be told."""


def time_axis(
    time: NDArray[np.float64], table: RawTable, where: str
) -> tuple[NDArray[np.float64], NDArray[np.bool_], tuple[str, ...]]:
    """Check the time stamps of one test.

    Args:
        time: [n] s, as recorded.
        table: Its rows, for messages.
        where: The file, for messages.

    Returns:
        Strictly increasing time [m] s; which of the n rows are kept; what was changed.

    Raises:
        DataError: Time goes backwards, or most stamps repeat.
    """
    keep = np.ones(len(time), dtype=bool)
    step = np.diff(time)
    if (step < 0).any():
        row = int(np.argmax(step < 0))
        raise DataError(
            f"time goes backwards, from {time[row]:.9g} s to {time[row + 1]:.9g} s",
            where=f"{where}, {table.place(row + 1)}",
            advice="If the file holds several tests, add a column `test` that names each row's "
            "test; else export it again",
        )
    repeats = step == 0
    if not repeats.any():
        return time, keep, ()
    count, row = int(repeats.sum()), int(np.argmax(repeats)) + 1
    said = f"{TIME_CHANGE} repeat in {count} of {len(time)} rows (first in {table.place(row)})"
    if count >= _ROUNDED_SHARE * len(step):
        even = _even(time)
        if even is not None:
            period = (even[-1] - even[0]) / (len(even) - 1)
            return even, keep, (f"{said}: rounded; rebuilt evenly with a step of {period:.6g} s",)
    if count > _MOST_REPEATED * len(step):
        raise DataError(
            f"{said}, and they are not an even sampling that was rounded",
            where=where,
            advice="Export the time with more digits",
        )
    keep[1:] = ~repeats
    return time[keep], keep, (f"{said}: the rows that repeat one were left out",)


def _even(time: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The even sampling that `time` was rounded from, if there is one."""
    index = np.arange(len(time), dtype=np.float64)
    if not time[-1] > time[0]:
        return None
    slope, start = np.polyfit(index, time, 1)
    even = start + slope * index
    resolution = float(np.min(np.diff(np.unique(time))))
    return even if slope > 0 and np.max(np.abs(time - even)) <= 1.01 * resolution else None
