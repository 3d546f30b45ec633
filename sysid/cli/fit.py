"""`sysid fit`: from a folder of measured tests to a model card."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sysid.cli.console import Talk
from sysid.cli.options import (
    CampaignArgument,
    FlipForce,
    Json,
    ManifestOption,
    Model,
    Quiet,
    Seed,
    duration,
    span,
    variant_of,
)
from sysid.errors import FitError

if TYPE_CHECKING:
    from sysid.cli.drawing import Draws
    from sysid.cli.identify import Identified
    from sysid.cli.selection import Part


class Weighting(StrEnum):
    """How tests are weighted."""

    paper = "paper"
    peak = "peak"
    noise = "noise"


class Kind(StrEnum):
    """Likelihood of a posterior."""

    full = "full"
    random_effects = "random_effects"
    independent = "independent"
    power = "power"


@dataclass(frozen=True)
class Order:
    """What was asked for, apart from the campaign."""

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
    talk: Talk


def fit(
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
            "noise: by its noise floor."
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
            "only: others take minutes.",
        ),
    ] = None,
    posterior_budget: Annotated[
        str,
        typer.Option(metavar="TIME", help="Longest time that each posterior may take, e.g. 5min."),
    ] = "60s",
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
        bool, typer.Option("--each", help="One fit for every sub-folder of CAMPAIGN.")
    ] = False,
    flip_force: FlipForce = False,
    manifest: ManifestOption = None,
    json: Json = False,
    seed: Seed = 0,
    quiet: Quiet = False,
) -> None:
    """Identify a damper: writes card.json, fit.json and figures into DIR.

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

    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.drawing import Draws, forget_parts
    from sysid.cli.selection import parts_of
    from sysid.data.whole_file import need_writable, write_files
    from sysid.identification.families import family

    need_writable(output)
    keep_compiled(talk)
    if posterior is None:
        posterior = family(model.value).memoryless
    if posterior:
        talk.note(f"The posterior may take {budget:g} s (--posterior-budget, --no-posterior).")
    order = Order(
        model, chosen, weights, tuple(holdout or ()), tuple(exclude or ()),
        parts_of(frequencies, amplitudes), flip_force, manifest, seed,
        Draws(likelihood.value, budget) if posterior else None, output, talk,
    )  # fmt: skip
    folders = _sub_folders(campaign) if each else {"": campaign}
    files: dict[str, bytes] = {}
    results: dict[str, Any] = {}
    reasons: list[str] = []
    for name, folder in folders.items():
        for number, result in enumerate(_fit_folder(folder, name, order), start=1):
            suffix = f"-{number}" if len(order.parts) > 1 else ""
            key = f"{name}/" if name else ""
            files |= {f"{key}{file}": content for file, content in result.files.items()}
            results[f"{key}fit{suffix}.json"] = result.summary
            reasons += [f"{key}card{suffix}.json: {reason}" for reason in result.distrust]
    write_files(files, output)
    forget_parts(output, files)
    talk.say(f"Written to {output}: {', '.join(sorted(files))}")
    talk.result(next(iter(results.values())) if len(results) == 1 else {"fits": results})
    if reasons:
        talk.distrust(reasons)
        raise typer.Exit(3)


def _fit_folder(folder: Path, name: str, order: Order) -> "list[Identified]":
    """All fits of one campaign, one a part."""
    from sysid.cli.drawing import show_posterior
    from sysid.cli.identify import identify
    from sysid.cli.selection import restrict, select
    from sysid.cli.sweep import show_sweep
    from sysid.cli.tables import show_fit
    from sysid.data.campaign import load_campaign

    talk = order.talk
    with talk.progress(f"Reading {folder}"):
        campaign = load_campaign(folder, order.manifest, flip_force=order.flip_force)
        chosen = select(campaign, order.holdout, order.exclude)
    talk.notes(campaign.notes)
    talk.left_out(chosen.left_out)
    results = []
    for number, part in enumerate(order.parts, start=1):
        several = len(order.parts) > 1
        selection = restrict(chosen, part, campaign.records)
        if not (~selection.held_out).any():
            raise FitError(
                f"no test is left to fit ({part.words()})",
                where=folder,
                advice="Look at the reasons above, or run `sysid check`",
            )
        with talk.progress(f"Fitting {campaign.name} ({part.words()})") as progress:
            result = identify(
                campaign, selection, model=order.model.value, variant=order.variant,
                weights=order.weights.value, seed=order.seed,
                suffix=f"-{number}" if several else "",
                remarks=(f"Only tests of {part.words()} were fitted.",) if several else (),
                draws=order.draws, folder=order.output / name, progress=progress,
            )  # fmt: skip
        title = " · ".join(z for z in (name or campaign.name, part.words() if several else "") if z)
        show_fit(talk, title, result.fit, result.intervals)
        if result.drawn is not None:
            show_posterior(talk, title, result.drawn)
        if result.sweep is not None:
            show_sweep(talk, result.sweep)
        results.append(result)
    return results


def _sub_folders(campaign: Path) -> dict[str, Path]:
    """Sub-folders of a folder, by name."""
    try:
        found = {p.name: p for p in sorted(campaign.iterdir()) if p.is_dir()}
    except OSError as cause:
        raise FitError(
            f"cannot be read: {cause.strerror}", where=campaign, advice="Give a folder of folders"
        ) from cause
    folders = {name: path for name, path in found.items() if not name.startswith(".")}
    if not folders:
        raise FitError(
            "has no sub-folders",
            where=campaign,
            advice="Leave --each out to fit this folder itself",
        )
    return folders
