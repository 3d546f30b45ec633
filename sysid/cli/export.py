"""`sysid export`: a card for other people's simulators."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from sysid.cli.console import Talk
from sysid.cli.options import CardArgument, Json, Quiet, UnusedSeed

if TYPE_CHECKING:
    from sysid.cards.export.pieces import Pieces
    from sysid.cards.schema import Card
    from sysid.models.damper import Damper


class Format(StrEnum):
    """What a card can be exported to."""

    FMU = "fmu"
    C = "c"
    MODELICA = "modelica"
    CSV = "csv"


ENDINGS: Final = {Format.FMU: ".fmu", Format.C: ".c", Format.MODELICA: ".mo", Format.CSV: ".csv"}
"""Of the file that is asked for."""


def export(
    card: CardArgument,
    to: Annotated[
        Format,
        typer.Option(
            "--to",
            help="fmu: FMI 2.0 co-simulation with source and a binary for this machine; "
            "c: C99 source, header and test program; modelica: a package around the C source; "
            "csv: a table over speed, current and temperature, which has no hysteresis.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="The file to write, named .fmu, .c, .mo or .csv; what belongs to it (a header, "
            "a test program) is written beside it.",
        ),
    ],
    json: Json = False,
    seed: UnusedSeed = 0,
    quiet: Quiet = False,
) -> None:
    """Write a card as a program that other simulators run: FMU, C, Modelica or a table.

    Where a C compiler is at hand the exported program is built and computes the card's check
    vectors before anything is written; exit code 3 where it does not agree, or is no C to it.
    """
    talk = Talk(json, quiet)
    name = _name(to, output)

    from sysid.cards.read import read_card
    from sysid.cards.verify import verify
    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.doubted import told_of_doubts

    parsed = read_card(card, check=False)
    doubted = told_of_doubts(talk, parsed, card)
    keep_compiled(talk)
    damper = verify(parsed, where=str(card))
    if to is Format.CSV:
        _table(talk, parsed, damper, output, doubted)
        return

    from sysid.cards.export.c_program import c_program
    from sysid.cards.export.compiler import tested
    from sysid.cards.export.modelica import tested_package
    from sysid.cards.export.pieces import pieces_of
    from sysid.data.whole_file import write_files

    pieces = pieces_of(damper, parsed.model, where=str(card))
    program = c_program(parsed, pieces, name)
    if to is Format.MODELICA:
        agrees, said = tested_package(program, name)
    else:
        agrees, said = tested(program, name, f"{name}.c")
    files, notes = _files(to, parsed, pieces, program, output)
    if agrees is None:
        notes.append(f"whether the program computes the check vectors is not known: {said}")
    write_files(files, output.parent)
    written = [str(output.parent / file) for file in files]
    talk.notes([*pieces.without_say, *notes])
    talk.say(f"{', '.join(written)}\n{said}")
    talk.result(
        {
            "files": written, "format": str(to), "check": said, "agrees": agrees,
            "notes": [*doubted, *pieces.without_say, *notes],
        }
    )  # fmt: skip
    if agrees is False:
        talk.distrust([f"the exported program does not compute the card's check vectors: {said}"])
        raise typer.Exit(3)


def _name(to: Format, output: Path) -> str:
    """The program's name, from the file's; wrong usage where it cannot be one."""
    from sysid.cards.export.identifier import identifier

    if output.suffix.lower() != ENDINGS[to]:
        raise typer.BadParameter(
            f"{output.name!r} does not end in {ENDINGS[to]}; --to {to} writes such a file",
            param_hint="--output",
        )
    name = identifier(output.stem)
    made = f"{name[0].upper()}{name[1:]}" if to is Format.MODELICA else name
    if to in (Format.C, Format.MODELICA) and made != output.stem:
        raise typer.BadParameter(
            f"{output.name!r} would hold a program of another name; take {made}{ENDINGS[to]}",
            param_hint="--output",
        )
    return name


def _files(
    to: Format, card: "Card", pieces: "Pieces", program: dict[str, str], output: Path
) -> tuple[dict[str, bytes], list[str]]:
    """Name → content, and what the user should know."""
    name = _name(to, output)
    if to is Format.FMU:
        from sysid.cards.export.fmu import fmu_of

        fmu = fmu_of(card, pieces, name)
        if fmu.platform is None:
            return {output.name: fmu.data}, [
                f"the FMU has C source but no binary ({fmu.why}): simulators must compile it"
            ]
        return {output.name: fmu.data}, [f"the FMU has C source and a binary for {fmu.platform}"]
    if to is Format.MODELICA:
        from sysid.cards.export.modelica import modelica_package

        program = modelica_package(card, pieces, name)
    return {file: text.encode() for file, text in program.items()}, []


def _table(
    talk: Talk, card: "Card", damper: "Damper", output: Path, doubted: tuple[str, ...]
) -> None:
    """Write the look-up table and say what it loses."""
    from sysid.cards.export.tables import table_csv, table_of
    from sysid.data.whole_file import write_files

    table = table_of(card, damper)
    write_files({output.name: table_csv(table, card).encode()}, output.parent)
    lost = (
        f"the table has no hysteresis: on steady loops of {1e3 * table.amplitude:.4g} mm it is "
        f"wrong by {table.lost:.1%} of max|F|, and its energy per cycle is {table.energy:.1%} of "
        "the loop's"
    )
    notes = [lost, *table.without_say]
    talk.notes(notes)
    talk.say(f"{output}: {table.force.size} rows")
    result: dict[str, Any] = {
        "files": [str(output)], "format": "csv", "rows": int(table.force.size),
        "lost_nrmse": table.lost, "energy_share": table.energy, "notes": [*doubted, *notes],
    }  # fmt: skip
    talk.result(result)
