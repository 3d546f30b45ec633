"""`sysid isolator`: a damper's card in a vibration isolator under skyhook control."""

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from sysid.cli.console import Talk
from sysid.cli.options import CardArgument, Json, Quiet, Seed, duration

if TYPE_CHECKING:
    from rich.table import Table

    from sysid.isolator.card_study import CardStudy
    from sysid.isolator.compare import Band


class Controller(StrEnum):
    """Controllers of the current."""

    P = "P"
    PID = "PID"
    GS = "GS"
    OO = "OO"


class PlantKind(StrEnum):
    """Plants."""

    mass = "mass"
    quarter_car = "quarter-car"


_RAN_AWAY: Final = "a run ran away"
FILES: Final = ("isolator.json", "conflict.png", "laws.png", "rig.png")
"""All that it may write; the last two only of some orders."""


def isolator(
    card: CardArgument,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for results and figures.")
    ],
    plant: Annotated[
        PlantKind,
        typer.Option(help="A mass on a spring over filtered noise, or a quarter car on a road."),
    ] = PlantKind.mass,
    controller: Annotated[
        list[Controller] | None,
        typer.Option(
            "--controller",
            help="P, PID, GS (gain scheduling) or OO (on/off); may be repeated. \\[default: all]",
        ),
    ] = None,
    motions: Annotated[
        int, typer.Option("--motions", min=1, max=1000, help="Motions of the base.")
    ] = 20,
    draws: Annotated[
        int | None,
        typer.Option(
            "--draws",
            min=0,
            max=1000,
            help="Dampers drawn from the card's posterior, or else its covariance; 0: none. "
            "\\[default: 20]",
        ),
    ] = None,
    length: Annotated[
        str, typer.Option("--duration", metavar="TIME", help="Of each motion, e.g. 5s.")
    ] = "5s",
    tune: Annotated[
        bool,
        typer.Option(
            "--tune",
            help="Find gains for this damper: PID after Ziegler and Nichols, P by search. "
            "\\[default: those of Batterbee and Sims]",
        ),
    ] = False,
    json: Json = False,
    seed: Seed = 1,
    quiet: Quiet = False,
) -> None:
    """Put a card into an isolator: conflict diagrams over temperature and set point.

    Writes isolator.json and figures. Exit code 3 where the piston often moves faster than in the
    tests that the card was identified from.
    """
    talk = Talk(json, quiet)
    seconds = duration(length, "--duration")
    if seed < 0:
        raise typer.BadParameter("a seed is not negative", param_hint="--seed")

    from sysid.cards.read import read_card
    from sysid.cards.write import json_text
    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.doubted import told_of_doubts
    from sysid.cli.left_behind import told_of_earlier
    from sysid.data.whole_file import need_writable, write_files

    need_writable(output)
    parsed = read_card(card, check=False)
    doubted = told_of_doubts(talk, parsed, card)
    keep_compiled(talk)
    from sysid.isolator.card_study import Order, study_card
    from sysid.report.isolator_json import isolator_json

    chosen = tuple(dict.fromkeys(controller)) if controller else tuple(Controller)
    order = Order(plant.value, tuple(c.value for c in chosen), motions, draws, seconds, seed, tune)
    with talk.progress("Isolating") as say:
        study = study_card(parsed, order, where=str(card), say=say)
        say("figures")
        told = {**isolator_json(study), "notes": list(doubted)}
        files = {"isolator.json": json_text(told).encode("utf-8"), **_figures(study)}
        write_files(files, output)
    talk.notes((*told_of_earlier(output, files, FILES), *study.left_out))
    for table in _tables(study):
        talk.show(table)
    talk.say(f"{output}: {', '.join(files)}")
    talk.result(told)
    if not study.trusted:
        talk.distrust([
            f"the piston is faster than the card's tests, {study.fastest:.3g} m/s, for up to "
            f"{study.beyond:.1%} of the time"
        ])  # fmt: skip
        raise typer.Exit(3)


def _figures(study: "CardStudy") -> dict[str, bytes]:
    from sysid.report.conflict_plot import conflict_png, rig_png
    from sysid.report.warm_laws_plot import warm_laws_png

    files = {"conflict.png": conflict_png(study)}
    if study.laws:
        files["laws.png"] = warm_laws_png(study)
    if study.rig is not None:
        files["rig.png"] = rig_png(study)
    return files


def _tables(study: "CardStudy") -> list["Table"]:
    """Changes with temperature, and controllers at equal working space."""
    from rich.table import Table

    tables = []
    cold, warm = study.temperatures[0], study.temperatures[-1]
    motions = f"mean of {study.order.motions} motions, 95 % interval"
    if study.ultimate is not None:
        tables.append(_gains(study))
    if study.changes:
        table = Table(title=f"From {cold:g} to {warm:g} °C", caption=motions)
        for name in ("controller", "set point", "RMS acceleration", "RMS working space"):
            table.add_column(name)
        units = {c.name: c.unit for c in study.diagram.curves}
        for c in study.changes:
            point = f"{c.set_point:g} {units[c.name]}"
            table.add_row(c.name, point, _percent(c.acceleration), _percent(c.working_space))
        tables.append(table)
    if study.drawn:
        tables.append(_drawn(study))
    if any(study.rivals):
        first = study.diagram.curves[0].name
        table = Table(
            title=f"RMS acceleration over that of {first} at equal working space", caption=motions
        )
        for name in ("controller", "°C", "isolator", "simulated rig"):
            table.add_column(name)
        ends = sorted({0, len(study.temperatures) - 1})
        for place, end in enumerate(ends):
            rig = {r.name: r for r in study.rig_rivals[place]} if study.rig_rivals else {}
            for r in study.rivals[place]:
                beside = _percent(rig[r.name].excess) if r.name in rig else ""
                t = f"{study.temperatures[end]:g}"
                table.add_row(r.name, t, _percent(r.excess), beside)
        tables.append(table)
    return tables


def _drawn(study: "CardStudy") -> "Table":
    """How far the card's own uncertainty moves each controller."""
    from rich.table import Table

    from sysid.isolator.card_study import SHOWN
    from sysid.isolator.compare import nearest

    count = study.drawn[0].acceleration.shape[2]
    table = Table(
        title=f"{count} drawn dampers over the card's own",
        caption=f"95 % of the draws, from {study.drawn_from}",
    )
    for name in ("controller", "set point", "°C", "RMS acceleration", "RMS working space"):
        table.add_column(name)
    for d in study.drawn:
        point = f"{d.set_points[nearest(d.set_points, SHOWN[d.name])]:g} {d.unit}"
        for end in range(d.acceleration.shape[1]):
            t = study.temperatures[-1 if end else 0]
            table.add_row(d.name, point, f"{t:g}", *map(_spread, d.bands(end)))
    return table


def _gains(study: "CardStudy") -> "Table":
    """What was found, with the published gains beside."""
    from rich.table import Table

    from sysid.isolator.families import PAPER

    assert study.ultimate is not None
    found = study.ultimate
    table = Table(
        title=f"Gains at {study.gains.temperature:g} °C",
        caption=f"ultimate gain {found.gain:.3g} A/N, period {1e3 * found.period:.3g} ms",
    )
    for name in ("gain", "found", "Batterbee and Sims", "unit"):
        table.add_column(name)
    rows = zip(
        ("B", "G", "K_p", "K_i", "K_d"),
        (study.gains.feedback, study.gains.feedforward, *study.gains.pid),
        (PAPER.feedback, PAPER.feedforward, *PAPER.pid),
        ("-", "A/N", "A/N", "A/(N s)", "A s/N"),
        strict=True,
    )
    for name, mine, theirs, unit in rows:
        table.add_row(name, f"{mine:.3g}", f"{theirs:.3g}", unit)
    return table


def _spread(band: "Band") -> str:
    if not math.isfinite(band.value):
        return _RAN_AWAY
    return f"{100 * band.single_low:+.2f} … {100 * band.single_high:+.2f} %"


def _percent(band: "Band") -> str:
    if not math.isfinite(band.value):
        return _RAN_AWAY
    if band.low == float("-inf"):
        return f"{100 * band.value:+.2f} %"
    return f"{100 * band.value:+.2f} % ({100 * band.low:+.2f} … {100 * band.high:+.2f})"
