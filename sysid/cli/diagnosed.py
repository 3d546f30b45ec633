"""One diagnosis from selected tests to the files of its result."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sysid.cards.doubts import doubts
from sysid.cards.extended import card_of_diagnosis
from sysid.cards.open_questions import FILE as OPEN
from sysid.cards.open_questions import open_file, open_text
from sysid.cards.read import parse_card
from sysid.cards.verify import verify
from sysid.cards.write import card_text, json_text
from sysid.cli.selection import Selection
from sysid.data.loops import Loops
from sysid.diagnosis.result import Diagnosis
from sysid.identification.fit import errors_of
from sysid.models.base import AbstractModel
from sysid.models.simulate import simulate
from sysid.motion.history import history_of, with_history
from sysid.motion.motion import Motion, loop_motion
from sysid.report.before_after_plot import before_after_png
from sysid.report.diagnosis_json import diagnosis_json
from sysid.report.gain_plot import gain_png
from sysid.report.lack_of_fit_maps import lack_of_fit_png
from sysid.report.page.diagnosis_page import diagnosis_page
from sysid.report.page.provenance import Origin
from sysid.report.page.render import render
from sysid.report.screen_plot import screen_png

if TYPE_CHECKING:
    from sysid.data.campaign import Campaign
    from sysid.data.record import Record

SAME: Final = 1e-9
"""Largest deviation of the exported card from the diagnosed model, of the largest force."""

Held = tuple[str, float, float]


@dataclass(frozen=True)
class Diagnosed:
    """A diagnosis, ready to be written and shown.

    Attributes:
        diagnosis: The diagnosis.
        holdout: (id, error before, error after) of tests that entered no fit, RMSE/max|F|.
        summary: The content of diagnosis.json.
        files: Name → content, of everything that goes into the output folder.
        distrust: Why the result must not be trusted; empty where it may.
    """

    diagnosis: Diagnosis
    holdout: tuple[Held, ...]
    summary: dict[str, Any]
    files: dict[str, bytes]
    distrust: tuple[str, ...]


def diagnosed(
    campaign: "Campaign",
    selection: Selection,
    *,
    models: Sequence[tuple[str, str | None]] | None,
    max_effects: int,
    seed: int,
    command: str = "",
    output: Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> Diagnosed:
    """Diagnose, hold the exported card against the answer, and describe.

    Args:
        campaign: Where the tests come from.
        selection: Which tests are used; held-out ones only measure the error.
        models: (name, variant) of candidate bases; None for all.
        max_effects: Most effects to add.
        seed: Of everything random.
        command: As it was typed, for the page.
        output: Folder of the results, likewise.
        progress: Called with a line now and then.

    Raises:
        FitError: The tests cannot be diagnosed as asked.
    """
    from sysid.diagnosis.diagnose import diagnose_loops

    loops, records = selection.loops, campaign.records
    held = selection.held_out[: len(loops.ids)]
    used = loops.select(~held)
    found = diagnose_loops(
        used, models=models, max_effects=max_effects, seed=seed,
        history=history_of(used.ids, records, loops), progress=progress,
    )  # fmt: skip
    if progress is not None:
        progress("simulating the exported card")
    card = card_of_diagnosis(
        found, records, damper=campaign.name, campaign=campaign.name,
        remarks=(*doubts(selection.untrusted), *selection.doubts, *selection.remarks),
    )  # fmt: skip
    text = card_text(card)
    exported = verify(parse_card(text, where="card.json"), where="card.json")
    forces = np.asarray(simulate(exported, motion_of(found.loops, records, loops)))
    deviation = largest_deviation(forces, found.simulated_after)
    held_loops = loops.select(held)
    forces_held = held_forces(found, exported, held_loops, records, loops)
    holdout = held_errors(held_loops, forces_held)
    mean = float(np.mean([t.nrmse for t in errors_of(found.loops, forces)]))
    distrusted = (*selection.untrusted, *unlike(deviation))
    summary = diagnosis_json(
        found, holdout=holdout, left_out=left_out(selection) | set_aside(found),
        free_run=(mean, deviation), distrust=distrusted, notes=selection.remarks,
    )  # fmt: skip
    files = {"diagnosis.json": json_text(summary).encode(), "card.json": text.encode()}
    if found.open is not None:
        left = open_file(found.open, found, campaign.manifest)
        files[OPEN] = open_text(left).encode()
    if progress is not None:
        progress("drawing")
    origin = Origin(
        campaign.name, records, command=command, folder=str(campaign.folder),
        output=str(output or "DIR"), seed=seed,
        notes=(*campaign.notes, *selection.doubts, *selection.remarks),
        tolerance=campaign.manifest.tolerance.si(),
    )  # fmt: skip
    page = diagnosis_page(
        found, card, summary, origin, distrusted,
        (held_loops, forces_held),
    )  # fmt: skip
    files["report.html"] = render(page)
    return Diagnosed(
        diagnosis=found,
        holdout=holdout,
        summary=summary,
        files=files | figures(found),
        distrust=distrusted,
    )


def motion_of(loops: Loops, records: "Sequence[Record]", every: Loops) -> Motion:
    """Motion of loops with their place in the campaign, where that is known of all of them.

    Args:
        loops: Those that are simulated.
        records: All tests of the campaign.
        every: All of its loops.
    """
    return with_history(loop_motion(loops), history_of(loops.ids, records, every))


def largest_deviation(forces: np.ndarray, expected: np.ndarray) -> float:
    """Largest |difference| over the largest |expected|; infinite where a force is none.

    Args:
        forces: [L, J] N.
        expected: [L, J] N.
    """
    difference = np.abs(forces - expected)
    if not np.isfinite(difference).all():
        return float("inf")
    return float(difference.max() / (np.abs(expected).max() or 1.0))


def unlike(deviation: float) -> tuple[str, ...]:
    """Why an exported card must not be trusted; empty where it gives the diagnosed forces."""
    if deviation <= SAME:
        return ()
    return (
        f"card.json does not give the forces of the diagnosed model: they differ by "
        f"{deviation:.2g} of the largest force, {SAME:g} is allowed",
    )


def held_errors(held: Loops, forces: tuple[np.ndarray, ...]) -> tuple[Held, ...]:
    """Free-run errors of held-out tests: the base model's, and the exported card's.

    Args:
        held: L tests.
        forces: Of the two (`held_forces`), [L, J] N each.
    """
    if not held.ids:
        return ()
    before, after = (errors_of(held, f) for f in forces)
    return tuple((b.id, b.nrmse, a.nrmse) for b, a in zip(before, after, strict=True))


def held_forces(
    found: Diagnosis, exported: AbstractModel, held: Loops, records: "Sequence[Record]",
    every: Loops,
) -> tuple[np.ndarray, ...]:  # fmt: skip
    """Forces of the base model and of the exported card on held-out tests, [L, J] N each."""
    if not held.ids:
        return ()
    motion = motion_of(held, records, every)
    return tuple(np.asarray(simulate(m, motion)) for m in (found.base_damper, exported))


def left_out(selection: Selection) -> dict[str, str]:
    """Tests that a diagnosis does not use → the reason."""
    odd = {
        r.id: f"its motion is no sinusoid ({r.nominal.kind}); a diagnosis compares steady loops"
        for r in selection.others
    }
    return {**selection.left_out, **odd}


def set_aside(found: Diagnosis) -> dict[str, str]:
    """Tests that all others contradict → the reason."""
    odd = found.set_aside
    return {} if odd is None else dict(zip(odd.ids, odd.reasons, strict=True))


def figures(found: Diagnosis) -> dict[str, bytes]:
    """Name → PNG."""
    drawn = {
        "before_after.png": before_after_png(found),
        "gain.png": gain_png(found),
        "screen.png": screen_png(found) if found.screen else None,
        "lack_of_fit.png": lack_of_fit_png(found),
    }
    return {name: content for name, content in drawn.items() if content is not None}
