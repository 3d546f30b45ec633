"""A card as a Modelica package: the C source as an external object, sampled."""

from collections.abc import Mapping

from sysid.cards.doubts import doubts_of
from sysid.cards.export.c_program import c_program
from sysid.cards.export.c_source import entries_of
from sysid.cards.export.compiler import tested
from sysid.cards.export.identifier import ascii_text
from sysid.cards.export.pieces import Pieces
from sysid.cards.export.sources import filled
from sysid.cards.schema import Card


def modelica_package(card: Card, pieces: Pieces, name: str) -> dict[str, str]:
    """The files of a Modelica package.

    Modelica has no notion of the past of a sampled signal that is tried again and again, as
    equations with memory need, so the C source is called once a sampling interval.

    Args:
        card: What is exported.
        pieces: Of its damper.
        name: Of the package, and the prefix of its C source.

    Returns:
        File name → text: the package, and the C source and header that lie beside it.
    """
    program = c_program(card, pieces, name)
    parameters = "".join(
        f"//   {k:3d}  {ascii_text(e.symbol)} = {e.value:g} {ascii_text(e.unit)}\n"
        for k, e in enumerate(entries_of(pieces))
    )
    told = f"{card.damper.name}, identified from {card.damper.campaign} by {card.software}"
    told = ". ".join((told, *doubts_of(card)))
    package = name[0].upper() + name[1:]
    marks = {
        "PACKAGE": package,
        "NAME": name,
        "TOLD": ascii_text(told),
        "PARAMETERS": parameters,
        "CURRENT": f"{sum(card.validity.current) / 2:g}",
    }
    return {
        f"{package}.mo": filled("modelica.mo.in", marks),
        f"{name}.h": program[f"{name}.h"],
        f"{name}.c": program[f"{name}.c"],
        f"{name}_modelica.h": _header(name),
    }


def tested_package(program: Mapping[str, str], name: str) -> tuple[bool | None, str]:
    """Build the header that a Modelica tool includes, and compute the check vectors with it.

    Args:
        program: Header, source and test, from `c_program`.
        name: Of the source without ending.

    Returns:
        As `tested`.
    """
    source = f"{name}_modelica.c"
    included = {f"{name}_modelica.h": _header(name), source: f'#include "{name}_modelica.h"\n'}
    return tested({**program, **included}, name, source)


def _header(name: str) -> str:
    return filled("modelica.h.in", {"NAME": name, "UPPER": name.upper()})
