"""`sysid compare`: several cards on the same tests."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from sysid.cli.console import Talk
from sysid.cli.options import (
    FlipForce,
    Json,
    ManifestOption,
    Quiet,
    UnusedSeed,
    typed,
)
from sysid.errors import FitError

if TYPE_CHECKING:
    import numpy as np

    from sysid.cards.schema import Card
    from sysid.cli.selection import Selection
    from sysid.data.campaign import Campaign
    from sysid.data.record import Record
    from sysid.models.damper import Damper
    from sysid.motion.motion import Motion
    from sysid.report.page.comparison import CardErrors, Comparison


@dataclass(frozen=True)
class Compared:
    """Cards on the tests of a campaign.

    Attributes:
        names: Of the cards.
        cards: As read.
        errors: Of each card.
        ids: Of the tests, loops first.
        conditions: [n] number of each test's condition.
        forces: [L, J] N of each card.
        others: Other tests: record, motion, force of each card, [n] N.
        distrust: Why the comparison must not be trusted.
        notes: What parts of the cards these tests cannot put to work.
    """

    names: tuple[str, ...]
    cards: "tuple[Card, ...]"
    errors: "tuple[CardErrors, ...]"
    ids: tuple[str, ...]
    conditions: tuple[int, ...]
    forces: "tuple[np.ndarray, ...]"
    others: "tuple[tuple[Record, Motion, tuple[np.ndarray, ...]], ...]"
    distrust: tuple[str, ...]
    notes: tuple[str, ...]


def compare(
    context: typer.Context,
    cards: Annotated[
        list[Path], typer.Argument(metavar="CARD CARD…", help="Two or more card.json.")
    ],
    on: Annotated[
        Path,
        typer.Option("--on", metavar="CAMPAIGN", help="Tests that the cards have to predict."),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Folder for report.html and comparison.json."
        ),
    ] = None,
    manifest: ManifestOption = None,
    flip_force: FlipForce = False,
    json: Json = False,
    seed: UnusedSeed = 0,
    quiet: Quiet = False,
) -> None:
    """Say which of several cards predicts a campaign best, and whether that is certain.

    Says which tests a card was identified from, too: on those its error is no prediction. Exit
    code 3 where tests lie outside the validity of a card.
    """
    talk = Talk(json, quiet)
    if len(cards) < 2:
        raise typer.BadParameter("give two cards or more", param_hint="CARD")

    from sysid.cards.read import read_card
    from sysid.cards.verify import verify
    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.doubted import told_of_doubts
    from sysid.cli.selection import select
    from sysid.cli.validate import with_current
    from sysid.data.campaign import load_campaign
    from sysid.data.whole_file import need_writable, write_files

    if output is not None:
        need_writable(output)
    parsed = [read_card(path, check=False) for path in cards]
    own = zip(parsed, _names(cards), strict=True)
    doubted = [told for one, name in own for told in told_of_doubts(talk, one, name)]
    keep_compiled(talk)
    dampers = [verify(c, where=str(path)) for c, path in zip(parsed, cards, strict=True)]
    with talk.progress(f"Reading {on}"):
        loaded = load_campaign(on, manifest, flip_force=flip_force)
        chosen = with_current(select(loaded, (), ()))
    talk.notes(loaded.notes)
    talk.left_out(chosen.left_out)
    talk.warnings(chosen.doubts)
    if not chosen.loops.ids and not chosen.others:
        raise FitError("has no test that can be compared", where=on, advice="Run `sysid check`")
    with talk.progress(f"Simulating {len(cards)} cards"):
        found = _compared(_names(cards), parsed, dampers, loaded, chosen)

    from sysid.cards.write import json_text
    from sysid.report.page.comparison import compare as verdict_of
    from sysid.report.page.comparison import comparison_json

    verdict = verdict_of(found.errors, found.conditions)
    summary = comparison_json(
        loaded.name, found.ids, found.errors, found.conditions, chosen.left_out
    )
    summary["notes"] = [*doubted, *found.notes]
    summary |= {"trusted": not found.distrust, "distrust": list(found.distrust)}
    files: dict[str, bytes] = {}
    if output is not None:
        files = {
            "comparison.json": json_text(summary).encode(),
            "report.html": _page(found, verdict, loaded, chosen, typed(context), str(on)),
        }
        write_files(files, output)
    talk.say(verdict.sentence)
    for told in verdict.caution:
        talk.warn(told)
    talk.notes(found.notes)
    _show(talk, verdict)
    if output is not None:
        talk.say(f"Written to {output}: {', '.join(files)}")
    talk.result(summary)
    if found.distrust:
        talk.distrust(found.distrust)
        raise typer.Exit(3)


def _compared(
    names: tuple[str, ...],
    cards: "list[Card]",
    dampers: "list[Damper]",
    campaign: "Campaign",
    chosen: "Selection",
) -> Compared:
    import numpy as np

    from sysid.cli.validate import leaving, told_of_effects
    from sysid.identification.conditions import conditions
    from sysid.identification.fit import errors_of
    from sysid.identification.problem import record_motion
    from sysid.models.simulate import simulate
    from sysid.motion.history import history_of, with_history
    from sysid.motion.motion import loop_motion
    from sysid.report.page.comparison import CardErrors

    loops, records = chosen.loops, {r.id: r for r in campaign.records}
    forces: tuple[np.ndarray, ...] = ()
    history = history_of(loops.ids, campaign.records, loops)
    if loops.ids:
        motion = with_history(loop_motion(loops), history)
        forces = tuple(np.asarray(simulate(damper, motion)) for damper in dampers)
    motions = [record_motion(record) for record in chosen.others]
    others = tuple(
        (record, m, tuple(np.asarray(simulate(damper, m)) for damper in dampers))
        for record, m in zip(chosen.others, motions, strict=True)
    )
    ids = (*loops.ids, *(record.id for record in chosen.others))
    found, distrust = [], []
    for k, (name, card, damper) in enumerate(zip(names, cards, dampers, strict=True)):
        nrmse = [t.nrmse for t in errors_of(loops, forces[k])] if loops.ids else []
        nrmse += [_nrmse(record.force, own[k]) for record, _, own in others]
        hashes = {file.sha256 for file in card.data}
        left = leaving(card, damper, chosen)
        outside = np.array([bool(left[i]) for i in ids])
        seen = np.array([records[i].source.sha256 in hashes for i in ids])
        found.append(CardErrors(name, _words(card), np.array(nrmse), seen, outside))
        if outside.any():
            first = next(i for i in ids if left[i])
            distrust.append(
                f"{int(outside.sum())} of {len(ids)} tests lie outside the validity of {name}, "
                f"such as {first}: {'; '.join(left[first])}"
            )
    group = conditions(loops).tolist() if loops.ids else []
    group += [len(ids) + k for k in range(len(others))]
    notes = tuple(
        f"{name}: {sentence}"
        for name, damper in zip(names, dampers, strict=True)
        for sentence in told_of_effects(damper, chosen, history)
    )
    return Compared(
        names, tuple(cards), tuple(found), ids, tuple(group), forces, others, tuple(distrust), notes
    )


def _nrmse(measured: "np.ndarray", simulated: "np.ndarray") -> float:
    rms = float(((simulated - measured) ** 2).mean()) ** 0.5
    return rms / float(abs(measured).max())


def _names(paths: list[Path]) -> tuple[str, ...]:
    """What tells the cards apart: as typed; numbered where one was typed twice."""
    typed_so = [str(path) for path in paths]
    return tuple(
        f"{name} ({typed_so[: k + 1].count(name)})" if typed_so.count(name) > 1 else name
        for k, name in enumerate(typed_so)
    )


def _words(card: "Card") -> str:
    effects = "".join(f" + {effect.id}" for effect in card.effects)
    return f"{card.model}, {card.variant}{effects}"


def _show(talk: Talk, verdict: "Comparison") -> None:
    table = Table(title="RMSE of max|F| in free run, mean over tests", caption="* best")
    for name in ("card", "model", "all tests", "not seen before", "identified from", "outside"):
        table.add_column(name, justify="left" if name in ("card", "model") else "right")
    for name, *rest in verdict.rows:
        shown = f"{name} *" if name == verdict.best else name
        table.add_row(*map(escape, (shown, *rest)))
    talk.show(table)
    for name, more, better in verdict.differences:
        talk.say(f"{name} errs by {more} more; {verdict.best} errs less in {better} tests.")


def _page(
    found: Compared,
    verdict: "Comparison",
    campaign: "Campaign",
    chosen: "Selection",
    command: str,
    folder: str,
) -> bytes:
    from sysid.report.page.comparison_page import comparison_page
    from sysid.report.page.provenance import Origin
    from sysid.report.page.render import render

    origin = Origin(
        campaign.name, campaign.records, command=command, folder=folder,
        left_out=chosen.left_out, notes=campaign.notes,
        tolerance=campaign.manifest.tolerance.si(),
    )  # fmt: skip
    page = comparison_page(
        found.errors, found.cards, verdict, chosen.loops, found.forces, found.others, origin,
        chosen.left_out, found.distrust,
    )  # fmt: skip
    return render(page)
