"""What a fit was asked to be, and doing it: one campaign, one result for each part of it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from sysid.cli.console import ASKED_FOR
from sysid.cli.options import Model
from sysid.errors import FitError

if TYPE_CHECKING:
    from sysid.cli.drawing import Draws
    from sysid.cli.identify import Identified
    from sysid.cli.selection import Part, Selection
    from sysid.data.campaign import Campaign
    from sysid.report.page.provenance import Origin


class Weighting(StrEnum):
    """How tests are weighted."""

    paper = "paper"
    peak = "peak"
    noise = "noise"


@dataclass(frozen=True)
class Order:
    """What was asked for, apart from the campaign.

    Attributes:
        model: Of the damper.
        variant: Of the model.
        weights: Of the tests.
        holdout: Globs.
        exclude: Globs.
        parts: Each gets a fit of its own.
        flip_force: Turn the sign of the measured force.
        manifest: That lies elsewhere.
        seed: Of everything random.
        draws: From the posterior; none if None.
        output: Folder for the results.
        command: As it was typed, for the page.
        page: Make `report.html`.
    """

    model: Model
    variant: str
    weights: Weighting
    holdout: tuple[str, ...]
    exclude: tuple[str, ...]
    parts: "tuple[Part, ...]"
    flip_force: bool
    manifest: Path | None
    seed: int
    draws: "Draws | None"
    output: Path
    command: str = field(default="", repr=False)  # fleets know an order again by its repr
    page: bool = field(default=True, repr=False)

    def suffix(self, number: int) -> str:
        """Put behind the names of the files of a part, numbered from 1."""
        return f"-{number}" if len(self.parts) > 1 else ""


def read(folder: Path, order: Order) -> "tuple[Campaign, Selection]":
    """A campaign, and which of its tests are used."""
    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign

    campaign = load_campaign(
        folder, order.manifest, flip_force=order.flip_force, exclude=order.exclude
    )
    return campaign, select(campaign, order.holdout, order.exclude)


def fit_parts(
    campaign: "Campaign",
    chosen: "Selection",
    order: Order,
    folder: Path,
    progress: Callable[[str], None] | None = None,
) -> "Iterator[tuple[Part, Identified]]":
    """Fit every part.

    Args:
        campaign: Where the tests come from.
        chosen: Which are used.
        order: What was asked for.
        folder: Where chains grow.
        progress: Called with a line now and then.

    Raises:
        FitError: A part cannot be fitted as asked.
    """
    from sysid.cli.identify import identify
    from sysid.cli.selection import restrict

    several = len(order.parts) > 1
    selections = [restrict(chosen, part, campaign.records) for part in order.parts]
    for part, selection in zip(order.parts, selections, strict=True):
        if not (~selection.held_out).any():
            raise FitError(
                f"no test is left to fit ({part.words()})",
                where=campaign.folder,
                advice=_why_none(chosen, selection),
            )
    for number, (part, selection) in enumerate(zip(order.parts, selections, strict=True), start=1):
        yield part, identify(
            campaign, selection, model=order.model.value, variant=order.variant,
            weights=order.weights.value, seed=order.seed, suffix=order.suffix(number),
            remarks=(f"Only tests of {part.words()} were fitted.",) if several else (),
            draws=order.draws, folder=folder, origin=_origin(campaign, selection, order),
            progress=progress,
        )  # fmt: skip


def _why_none(chosen: "Selection", selection: "Selection") -> str:
    """What to change where no test is left in a part: options, before the tests.

    Args:
        chosen: Tests of all parts.
        selection: Of them, those of the part.
    """
    if selection.held_out.size:
        return f"--holdout holds out all {selection.held_out.size} tests there are: hold out fewer"
    if chosen.held_out.size:
        return (
            f"None of the {chosen.held_out.size} tests that can be used lies there: give other "
            "ranges (tests are in a range by their labels, else as measured)"
        )
    if ASKED_FOR in chosen.left_out.values():
        return "--exclude leaves out the tests that could be fitted: exclude fewer"
    return "Look at why tests are left out with `sysid check`"


def _origin(campaign: "Campaign", selection: "Selection", order: Order) -> "Origin | None":
    """What the page tells of the run."""
    if not order.page:
        return None
    from sysid.report.page.provenance import Origin

    return Origin(
        campaign.name, campaign.records, command=order.command, folder=str(campaign.folder),
        output=str(order.output), seed=order.seed, notes=(*campaign.notes, *selection.doubts),
        tolerance=campaign.manifest.tolerance.si(),
    )  # fmt: skip
