"""Steady motion of a record beside the part that a loop is cut from: another test in one file."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np
from jaxtyping import Float

from sysid.data.figures import figure
from sysid.data.record import Record
from sysid.errors import DataError

CYCLES: Final = 2
"""Steady cycles beside a steady part from which on they are told."""
FEWEST_CYCLES: Final = 3
"""Steady cycles of a piece of a record that has no steady part: random motion has two by chance."""
SHARE: Final = 1.0 / 3.0
"""Of the whole travel, on one side of the steady part, from which on it is told, steady or not."""
RAMP_SHARE: Final = 0.05
"""Of the whole travel: less is a ramp, and is not looked at."""
SWINGS: Final = 2 * CYCLES - 1
"""Passages through the middle that so many steady cycles have at least; ramps have fewer."""
MIDDLE: Final = 0.05
"""Of the range, on either side of the middle: what stays there has not passed through it."""
PIECES_SHARE: Final = 0.25
"""Of the whole travel, in steady pieces of a record that has no steady part."""
SEAM: Final = 3.0
"""Usual steps of time; motion behind a longer one is told with the gap."""
HALVINGS: Final = 5
"""How often such a record is halved."""
CURE: Final = "give each a file of its own, or add a column `test` that names each row's test"


class Part(Protocol):
    """Where a piece of a record moves steadily: what is asked of `steady.Steady`."""

    @property
    def start(self) -> int:
        """First sample."""
        ...

    @property
    def stop(self) -> int:
        """One past the last sample."""
        ...

    @property
    def cycles(self) -> int:
        """Number of whole cycles."""
        ...

    @property
    def amplitude(self) -> float:
        """Of the motion, m."""
        ...

    @property
    def frequency(self) -> float:
        """Of the motion, Hz."""
        ...


@dataclass(frozen=True)
class OtherMotion:
    """Motion on one side of the steady part.

    Attributes:
        side: Of the steady part.
        touches: It is steady up to the steady part's next sample.
        words: What it is, one sentence.
    """

    side: Literal["before", "after"]
    touches: bool
    words: str


def other_motions(
    record: Record, start: int, stop: int, find: Callable[[Record], Part]
) -> tuple[OtherMotion, ...]:
    """What moves before and after the steady part and is more than ramps.

    Args:
        record: The test.
        start: First sample of the steady part.
        stop: One past its last.
        find: Finds the steady part of a piece, or raises DataError.
    """
    travel, step = np.abs(np.diff(record.displacement)), np.diff(record.time)
    found = []
    sides: tuple[tuple[Literal["before", "after"], slice], ...] = (
        ("before", slice(0, start)),
        ("after", slice(stop, record.time.size)),
    )
    for side, part in sides:
        share = float(travel[part][:-1].sum() / travel.sum()) if part.stop > part.start + 1 else 0.0
        seam = step[start - 1 if side == "before" else stop - 1] if share else 0.0
        if share < RAMP_SHARE or seam > SEAM * float(np.median(step)):
            continue
        if share <= SHARE and _swings(record.displacement[part]) < SWINGS:
            continue
        steady = _steady_in(record, part, find)
        ends = f"({record.time[part][0]:.4g} to {record.time[part][-1]:.4g} s)"
        if steady is not None and steady.cycles >= CYCLES:
            first, last = steady.start == 0, steady.stop == part.stop - part.start
            words = f"{_told(steady)} {side} the steady part {ends} are left out"
            found.append(OtherMotion(side, first if side == "after" else last, words))
        elif share > SHARE:
            words = f"{100 * share:.0f} % of the travel lie {side} the steady part {ends}"
            found.append(OtherMotion(side, False, f"{words} and are left out"))
    return tuple(found)


def _swings(x: Float[np.ndarray, " n"]) -> int:
    """How often a displacement, m, passes through the middle of its range: quickly counted."""
    off = x - 0.5 * (x.min() + x.max())
    side = np.sign(off[np.abs(off) > MIDDLE * np.ptp(x)])
    return int(np.count_nonzero(np.diff(side)))


def several_motions(record: Record, find: Callable[[Record], Part]) -> str | None:
    """Why a record has no steady part, if steady motions follow each other in it."""
    pieces = _pieces(record, slice(0, record.time.size), find, HALVINGS)
    travel = np.abs(np.diff(record.displacement))
    inside = sum(float(travel[part].sum()) for part, _ in pieces)
    if len(pieces) < 2 or inside < PIECES_SHARE * float(travel.sum()):
        return None
    longest = max((steady for _, steady in pieces), key=lambda steady: steady.cycles)
    return f"several steady motions follow each other, such as {_told(longest)}: {CURE}"


def _told(steady: Part) -> str:
    return (
        f"{steady.cycles} cycles of {figure(1e3 * steady.amplitude, 3)} mm at "
        f"{figure(steady.frequency, 3)} Hz"
    )


def _steady_in(record: Record, part: slice, find: Callable[[Record], Part]) -> Part | None:
    piece = Record(record.id, record.time[part], record.displacement[part], record.force[part])
    try:
        return find(piece)
    except DataError:
        return None


def _pieces(
    record: Record, part: slice, find: Callable[[Record], Part], halvings: int
) -> list[tuple[slice, Part]]:
    """Steady pieces of a record, by halving what has none."""
    steady = _steady_in(record, part, find)
    if steady is not None:
        inside = slice(part.start + steady.start, part.start + steady.stop - 1)
        return [(inside, steady)] if steady.cycles >= FEWEST_CYCLES else []
    if halvings == 0:
        return []
    middle = (part.start + part.stop) // 2
    halves = (slice(part.start, middle), slice(middle, part.stop))
    return [piece for half in halves for piece in _pieces(record, half, find, halvings - 1)]
