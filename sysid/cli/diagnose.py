"""`sysid diagnose`: what the simulation gets wrong, why, and what it is worth to mend it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from sysid.cli.console import Talk
from sysid.cli.options import (
    VARIANTS,
    CampaignArgument,
    FlipForce,
    Json,
    ManifestOption,
    Model,
    Quiet,
    Seed,
    typed,
)
from sysid.errors import CardError, FitError, Stopped

if TYPE_CHECKING:
    from sysid.cli.diagnosed import Diagnosed
    from sysid.diagnosis.result import Diagnosis

Bases = list[tuple[str, str | None]]

STOPPED: Final = (
    "Stopped before the end; no result was written. A diagnosis cannot go on where it stopped: the "
    "same command begins anew. It ends sooner with one base (--model) or fewer effects "
    "(--max-effects)."
)


def diagnose(
    context: typer.Context,
    campaign: CampaignArgument,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the results.")
    ],
    card: Annotated[
        Path | None,
        typer.Option(metavar="CARD", help="Use the model and variant of this card as the base."),
    ] = None,
    model: Annotated[
        list[Model] | None,
        typer.Option(
            help="A base model to try; repeatable. Without it, all that fit in seconds are tried, "
            "the others where those are far off, and the smallest held-out error wins."
        ),
    ] = None,
    holdout: Annotated[
        list[str] | None,
        typer.Option(metavar="GLOB", help="Tests that only measure the error; repeatable."),
    ] = None,
    exclude: Annotated[
        list[str] | None, typer.Option(metavar="GLOB", help="Tests to leave out; repeatable.")
    ] = None,
    max_effects: Annotated[
        int, typer.Option("--max-effects", metavar="N", min=1, help="Most effects to add.")
    ] = 8,
    flip_force: FlipForce = False,
    manifest: ManifestOption = None,
    json: Json = False,
    seed: Seed = 0,
    quiet: Quiet = False,
) -> None:
    """Say what the model gets wrong, name the cause, extend the model, measure the gain.

    Writes diagnosis.json, card.json (the extended model), report.html and figures into DIR.
    "Unknown" and "nothing" are answers, too: exit code 0. Tests with a fault that makes them
    useless are left out with notice. A diagnosis that is stopped (Ctrl-C) leaves nothing, and the
    same command begins anew.
    """
    talk = Talk(json, quiet)
    if card is not None and model:
        raise typer.BadParameter("give --card or --model, not both", param_hint="--card")

    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign
    from sysid.data.whole_file import need_writable, write_files

    need_writable(output)
    bases = _bases(card, model or (), talk)
    keep_compiled(talk, many=True)
    with talk.progress(f"Reading {campaign}"):
        asked = tuple(exclude or ())
        loaded = load_campaign(campaign, manifest, flip_force=flip_force, exclude=asked)
        chosen = select(loaded, tuple(holdout or ()), asked)

    from sysid.cli.diagnosed import diagnosed, left_out
    from sysid.cli.diagnosis_tables import show_diagnosis
    from sysid.cli.left_behind import told_of_earlier

    talk.notes(loaded.notes)
    talk.left_out(left_out(chosen))
    talk.warnings(chosen.doubts)
    talk.notes(chosen.remarks)
    if chosen.held_out[: len(chosen.loops.ids)].all():
        raise FitError(
            "no steady loop is left to diagnose",
            where=campaign,
            advice="Look at the reasons above, or run `sysid check`",
        )
    try:
        with talk.progress(f"Diagnosing {loaded.name}") as progress:
            result = diagnosed(
                loaded, chosen, models=bases, max_effects=max_effects, seed=seed,
                command=typed(context), output=output, progress=progress,
            )  # fmt: skip
    except KeyboardInterrupt as cause:
        raise Stopped(STOPPED) from cause
    write_files(result.files, output)
    talk.notes((*told_of_earlier(output, result.files), *result.diagnosis.notes))
    show_diagnosis(talk, result)
    if bases is None:
        _tell_of_lumped(talk, result.diagnosis)
    _end(talk, result, output)


def _tell_of_lumped(talk: Talk, diagnosis: "Diagnosis") -> None:
    """Where no base will do, the one that is tried on sweeps over temperature alone."""
    tried = {rival.model for rival in diagnosis.rivals}
    if diagnosis.answer == "base_inadequate" and "lumped" not in tried:
        talk.say(
            "The lumped model (Batterbee and Sims), whose laws are lines in temperature, was not "
            "tried, because these tests are no sweep over temperature. Ask for it with "
            "--model lumped."
        )


def _end(talk: Talk, result: "Diagnosed", output: Path) -> None:
    talk.say(f"Written to {output}: {', '.join(sorted(result.files))}")
    talk.result(result.summary)
    if result.distrust:
        talk.distrust(result.distrust)
        raise typer.Exit(3)


def _bases(card: Path | None, models: "list[Model] | tuple[()]", talk: Talk) -> Bases | None:
    """Base models to try, None for all."""
    if card is None:
        return [(name, None) for name in dict.fromkeys(m.value for m in models)] or None

    from sysid.cards.read import read_card

    known = read_card(card, check=False)
    variants = next((v for model, v in VARIANTS.items() if model.value == known.model), None)
    if variants is None or known.variant not in variants:
        what = f"model {known.model!r}" if variants is None else f"variant {known.variant!r}"
        raise CardError(
            f"{what} is not known to this program",
            where=card,
            advice="Give a card of this version, or update sysid; it knows: "
            + ", ".join(variants or VARIANTS),
        )
    if known.effects:
        names = ", ".join(effect.id for effect in known.effects)
        talk.note(f"Note: the effects in {card} ({names}) are not taken over but looked for anew.")
    return [(known.model, known.variant)]
