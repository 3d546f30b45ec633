"""`sysid fit`: from a folder of measured tests to a model card."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sysid.cli.console import Talk
from sysid.cli.fit_order import Order, Weighting, fit_parts, read
from sysid.cli.options import (
    CampaignArgument,
    FlipForce,
    Json,
    ManifestOption,
    Model,
    Quiet,
    Seed,
    duration,
    given,
    span,
    typed,
    variant_of,
)
from sysid.cli.workers import SchedulerOption, Workers

if TYPE_CHECKING:
    from sysid.cli.identify import Identified


class Kind(StrEnum):
    """Likelihood of a posterior."""

    full = "full"
    random_effects = "random_effects"
    independent = "independent"
    power = "power"


def fit(
    context: typer.Context,
    campaign: CampaignArgument,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the results.")
    ],
    model: Annotated[Model, typer.Option(help="The damper model.")] = Model.generalized,
    variant: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Of the generalized model: asymmetric (default): all parameters; symmetric: "
            "compression and rebound alike; passive: symmetric without current; mean: symmetric "
            "without hysteresis. Of the lumped model: paper (default): C_pre and m_l as published; "
            "full: both free. The other models have one variant, full.",
        ),
    ] = None,
    weights: Annotated[
        Weighting,
        typer.Option(
            help="paper: every point alike (W11 Eq. 11); peak: each test divided by its max|F|; "
            "noise: by its repeatability."
        ),
    ] = Weighting.paper,
    holdout: Annotated[
        list[str] | None,
        typer.Option(metavar="GLOB", help="Tests that only measure the error; repeatable."),
    ] = None,
    exclude: Annotated[
        list[str] | None, typer.Option(metavar="GLOB", help="Tests to leave out; repeatable.")
    ] = None,
    posterior: Annotated[
        bool | None,
        typer.Option(
            "--posterior/--no-posterior",
            help="Draw from the posterior, and profile it: posterior.h5, corner.png, trace.png, "
            "profiles.png, bands.png, and a summary in the card. Unasked for models without memory "
            "only, since others take minutes, and not for fleets.",
        ),
    ] = None,
    posterior_budget: Annotated[
        str,
        typer.Option(
            metavar="TIME",
            help="Time after which each posterior ends, converged or not, e.g. 5min; its warm-up "
            "and a first block of draws are finished in any case.",
        ),
    ] = "90s",
    likelihood: Annotated[
        Kind,
        typer.Option(
            help="Of the posterior. full: noise, errors of the rig from test to test, smooth "
            "errors of the model's laws; random_effects: without the last; independent: noise "
            "alone, far too sure; power: the same, tempered by the scatter between conditions."
        ),
    ] = Kind.full,
    frequency_range: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LO HI",
            help="Fit only tests labelled LO to HI Hz. Repeated: one card each, card-1.json, …",
        ),
    ] = None,
    amplitude_range: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LO HI", help="The same by amplitude, e.g. 2mm 13mm; a bare number is in mm."
        ),
    ] = None,
    each: Annotated[
        bool,
        typer.Option(
            "--each",
            help="A fleet: one fit for every sub-folder of CAMPAIGN, many at once, and a table of "
            "all, fleet.csv. What is finished is not done again.",
        ),
    ] = False,
    workers: Workers = None,
    scheduler: SchedulerOption = None,
    flip_force: FlipForce = False,
    manifest: ManifestOption = None,
    json: Json = False,
    seed: Seed = 0,
    quiet: Quiet = False,
) -> None:
    """Identify a damper: writes card.json, fit.json, report.html and figures into DIR.

    No start value is needed. Tests with a fault that makes them useless are left out with notice.
    Exit code 3 where the fit must not be trusted.
    """
    talk = Talk(json, quiet)
    chosen = variant_of(model, variant)
    frequencies = [span(r, "frequency", "--frequency-range", "Hz") for r in frequency_range or ()]
    budget = duration(posterior_budget, "--posterior-budget")
    amplitudes = [span(r, "displacement", "--amplitude-range", "mm") for r in amplitude_range or ()]
    if each and manifest is not None:
        raise typer.BadParameter(
            "--each reads the campaign.toml of every sub-folder, not --manifest"
        )
    if not each and (workers or scheduler):
        raise typer.BadParameter("--workers and --scheduler are for --each")
    about_draws = given(context, "posterior_budget", "likelihood")
    if about_draws and posterior is False:
        raise typer.BadParameter(
            f"{' and '.join(about_draws)} say how to draw from the posterior; --no-posterior draws "
            "nothing"
        )

    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.drawing import Draws, forget_parts
    from sysid.cli.left_behind import told_of_earlier
    from sysid.cli.selection import parts_of
    from sysid.data.whole_file import need_writable, write_files
    from sysid.identification.families import family

    need_writable(output)
    keep_compiled(talk)
    if posterior is None:
        posterior = bool(about_draws) or (family(model.value).memoryless and not each)
    order = Order(
        model, chosen, weights, tuple(holdout or ()), tuple(exclude or ()),
        parts_of(frequencies, amplitudes), flip_force, manifest, seed,
        Draws(likelihood.value, budget) if posterior else None, output,
        command=typed(context), page=not each,
    )  # fmt: skip
    if each:
        from sysid.cli.fleet import fit_each

        _tell_budget(talk, order)
        fit_each(talk, campaign, order, workers, scheduler)
        return
    files: dict[str, bytes] = {}
    results: dict[str, Any] = {}
    reasons: list[str] = []
    fitted = _fit_folder(talk, campaign, order)
    for number, (_, result) in enumerate(fitted, start=1):
        suffix = order.suffix(number)
        files |= result.files
        results[f"fit{suffix}.json"] = result.summary
        reasons += [f"card{suffix}.json: {reason}" for reason in result.distrust]
    write_files(files, output)
    forget_parts(output, files)
    talk.notes(told_of_earlier(output, files))
    _show(talk, fitted)
    talk.say(f"Written to {output}: {', '.join(sorted(files))}")
    talk.result(next(iter(results.values())) if len(results) == 1 else {"fits": results})
    if reasons:
        talk.distrust(reasons)
        raise typer.Exit(3)


def _tell_budget(talk: Talk, order: Order) -> None:
    """Why a fit goes on for a while after it has found its parameters."""
    if order.draws is not None:
        talk.note(
            f"The posterior ends after {order.draws.budget:g} s, at its next block "
            "(--posterior-budget, --no-posterior)."
        )


def _fit_folder(talk: Talk, folder: Path, order: Order) -> "list[tuple[str, Identified]]":
    """All fits of one campaign, one a part, each with its title."""
    with talk.progress(f"Reading {folder}"):
        campaign, chosen = read(folder, order)
    talk.notes(campaign.notes)
    talk.left_out(chosen.left_out)
    talk.warnings(chosen.doubts)
    talk.notes(chosen.remarks)
    _tell_budget(talk, order)
    with talk.progress(f"Fitting {campaign.name}") as progress:
        found = list(fit_parts(campaign, chosen, order, order.output, progress))
    several = len(found) > 1
    return [
        (f"{campaign.name} · {part.words()}" if several else campaign.name, result)
        for part, result in found
    ]


def _show(talk: Talk, fitted: "list[tuple[str, Identified]]") -> None:
    """What people read, once everything is on the disk: a terminal may go away."""
    from sysid.cli.drawing import show_posterior
    from sysid.cli.sweep import show_sweep
    from sysid.cli.tables import show_fit

    for title, result in fitted:
        show_fit(talk, title, result.fit, result.intervals, result.noise)
        talk.notes(result.advice)
        for words in result.odd.words if result.odd else ():
            talk.warn(f"{words} Look at its record; --exclude leaves it out.")
        if result.drawn is not None:
            show_posterior(talk, title, result.drawn)
        if result.sweep is not None:
            show_sweep(talk, result.sweep)
