"""Which tests of a campaign a command uses, and why it does not use the others."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sysid.cli.console import ASKED_FOR
from sysid.cli.given_temperature import told_of_temperature
from sysid.cli.soundness import borne, borne_told, unfit
from sysid.cli.without_damper import told_without_damper
from sysid.data.loops import Loops
from sysid.data.quality import Fault, inspect
from sysid.data.record import OWN_GRID, Record
from sysid.data.split import hold_out

if TYPE_CHECKING:
    from sysid.data.campaign import Campaign

Range = tuple[float, float]


@dataclass(frozen=True)
class Selection:
    """Tests that can be used.

    Attributes:
        loops: L loops of tests that are used or held out.
        others: R tests of declared other motions, likewise, for their own time grids.
        held_out: [L + R] which of them are held out, loops first.
        left_out: Id → reason, for all other tests of the campaign.
        untrusted: Why a fit of this campaign would be meaningless.
        warnings: Id → what is wrong with a test and does not keep it out.
        remarks: What else is to be told of the tests, in sentences, and stands in all results.
    """

    loops: Loops
    others: tuple[Record, ...]
    held_out: np.ndarray
    left_out: dict[str, str]
    untrusted: tuple[str, ...]
    warnings: dict[str, tuple[Fault, ...]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is wrong with tests that are used all the same, a sentence a kind."""
        return borne_told(self.warnings, (*self.loops.ids, *(r.id for r in self.others)))


@dataclass(frozen=True)
class Part:
    """A part of the campaign that gets a model of its own.

    Attributes:
        frequency: Range in Hz, or None for all.
        amplitude: Range in m, or None for all.
    """

    frequency: Range | None = None
    amplitude: Range | None = None

    def words(self) -> str:
        """The ranges for people."""
        told = []
        if self.frequency is not None:
            told.append(f"{self.frequency[0]:g}–{self.frequency[1]:g} Hz")
        if self.amplitude is not None:
            told.append(f"{1e3 * self.amplitude[0]:g}–{1e3 * self.amplitude[1]:g} mm")
        return ", ".join(told) or "all tests"


def parts_of(frequency: Sequence[Range], amplitude: Sequence[Range]) -> tuple[Part, ...]:
    """One part for each pair of a frequency range and an amplitude range."""
    return tuple(Part(f, a) for f, a in product(frequency or (None,), amplitude or (None,)))


def select(campaign: "Campaign", holdout: Sequence[str], exclude: Sequence[str]) -> Selection:
    """Leave out what was asked for and what is not sound; the rest becomes loops.

    Args:
        campaign: The campaign.
        holdout: Globs on ids of tests that only measure the error.
        exclude: Globs on ids of tests to be left out.

    Raises:
        DataError: A glob matches no test.
    """
    ids = [record.id for record in campaign.records]
    excluded = dict(zip(ids, hold_out([*ids, *campaign.unread], exclude), strict=False))
    held = dict(zip(ids, hold_out(ids, holdout), strict=True))
    left_out = {name: ASKED_FOR for name in ids if excluded[name]}
    kept = tuple(record for record in campaign.records if not excluded[record.id])
    report = inspect(replace(campaign, records=kept))
    left_out |= report.cut.left_out | unfit(report)
    loops = report.cut.loops
    loops = loops.select(np.array([name not in left_out for name in loops.ids], dtype=bool))
    others = tuple(r for r in kept if r.nominal.kind in OWN_GRID and r.id not in unfit(report))
    left_out = {name: why for name, why in left_out.items() if name not in {r.id for r in others}}
    chosen = (*loops.ids, *(r.id for r in others))
    mask = np.array([held[name] for name in chosen], dtype=bool)
    return Selection(
        loops, others, mask, left_out, report.untrusted, borne(report),
        (*told_without_damper(kept), *told_of_temperature(kept)),
    )  # fmt: skip


def restrict(selection: Selection, part: Part, records: Sequence[Record]) -> Selection:
    """Keep the tests of one part.

    A test is in a range by its label, since that is how users name tests; by its measured value
    where it has none.  Tests that are not sinusoidal are in no range.
    """
    if part == Part():
        return selection
    by_id = {record.id: record.nominal for record in records}
    loops = selection.loops
    left_out = dict(selection.left_out)
    keep = np.ones(len(loops.ids), dtype=bool)
    for k, name in enumerate(loops.ids):
        label = by_id[name]
        frequency = label.frequency if label.frequency is not None else loops.frequency[k]
        amplitude = label.amplitude if label.amplitude is not None else loops.amplitude[k]
        if not (_within(frequency, part.frequency) and _within(amplitude, part.amplitude)):
            keep[k] = False
            left_out[name] = f"not in the range of this model ({part.words()})"
    left_out |= {r.id: "not sinusoidal, so in no range" for r in selection.others}
    held_out = selection.held_out[: keep.size][keep]
    return replace(
        selection, loops=loops.select(keep), others=(), held_out=held_out, left_out=left_out
    )


def _within(value: float, ends: Range | None) -> bool:
    return ends is None or ends[0] * (1 - 1e-9) <= value <= ends[1] * (1 + 1e-9)
