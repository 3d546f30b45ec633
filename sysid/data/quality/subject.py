"""One test as the checks see it: the record, and if it has them its steady part and loop."""

from dataclasses import dataclass, fields

import numpy as np
from jaxtyping import Float

from sysid.data.cycles import Loop, LoopSet, NoSteadyPartError, Steady, find_steady
from sysid.data.record import Record
from sysid.data.steady import Reason


@dataclass(frozen=True)
class Subject:
    """What is checked.

    Attributes:
        record: The whole test.
        steady: Its steady part; None where there is none or the kind is not ``sine``.
        loop: Its loop; None likewise.
        reason: Why there is no steady part; None if there is one, or none was looked for.
        left_out: Why the test gave no loop, one sentence; None if it gave one.
    """

    record: Record
    steady: Steady | None
    loop: Loop | None
    reason: Reason | None
    left_out: str | None

    @property
    def peak_force(self) -> float:
        """Largest magnitude of the mean loop's force, N (of the record's, without a loop)."""
        force = self.record.force if self.loop is None else self.loop.force
        return float(np.max(np.abs(force), where=np.isfinite(force), initial=0.0))

    def steady_part(self, channel: Float[np.ndarray, " n"]) -> Float[np.ndarray, " m"]:
        """The steady part of a channel of the record; all of it if there is none."""
        if self.steady is None:
            return channel
        return channel[self.steady.start : self.steady.stop]


def subjects(records: tuple[Record, ...], cut: LoopSet) -> tuple[Subject, ...]:
    """Put each record beside its loop."""
    place = {name: k for k, name in enumerate(cut.loops.ids)}
    found = []
    for record in records:
        k = place.get(record.id)
        if k is not None:
            found.append(Subject(record, cut.steady[k], _row(cut, k), None, None))
            continue
        steady, reason = None, None
        if record.nominal.kind == "sine":
            try:
                steady = find_steady(record)
            except NoSteadyPartError as error:
                reason = error.reason
        found.append(Subject(record, steady, None, reason, cut.left_out[record.id]))
    return tuple(found)


def _row(cut: LoopSet, k: int) -> Loop:
    names = [field.name for field in fields(Loop) if field.name != "id"]
    return Loop(id=cut.loops.ids[k], **{name: getattr(cut.loops, name)[k] for name in names})
