"""A card as a Modelica package: the C source as an external object, sampled."""

from collections.abc import Mapping

from sysid.cards.doubts import doubts_of
from sysid.cards.export.box import conditions, not_told, unknown_temperature
from sysid.cards.export.c_program import c_program
from sysid.cards.export.c_source import entries_of
from sysid.cards.export.compiler import tested
from sysid.cards.export.identifier import ascii_text
from sysid.cards.export.pieces import Pieces
from sysid.cards.export.sources import filled
from sysid.cards.outside import SLACK, TEMPERATURE_SLACK
from sysid.cards.schema import Card, Validity
from sysid.data.supply import same_current


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
    told = ". ".join((told, f"Identified at {conditions(card)}", *doubts_of(card)))
    ranges, outside = _range(card.validity)
    package = name[0].upper() + name[1:]
    marks = {
        "PACKAGE": package,
        "NAME": name,
        "TOLD": ascii_text(told),
        "PARAMETERS": parameters,
        "CURRENT": f"{sum(card.validity.current) / 2:g}",
        "UNKNOWN": f"{unknown_temperature(card, pieces):g}",
        "NOT_TOLD": not_told(card),
        "RANGES": ranges,
        "OUTSIDE": outside,
    }
    return {
        f"{package}.mo": filled("modelica.mo.in", marks),
        f"{name}.h": program[f"{name}.h"],
        f"{name}.c": program[f"{name}.c"],
        f"{name}_modelica.h": _header(name),
    }


def _range(box: Validity) -> tuple[str, str]:
    """Parameters for what one sample tells of a box, and that it is outside (`cards/outside`)."""
    meter = same_current(max(abs(box.current[0]), abs(box.current[1])))
    rows = [
        ("displacementMax", "m", box.amplitude[1], "largest distance from the centre"),
        ("velocityMax", "m/s", box.velocity[1], "largest speed"),
        ("currentMin", "A", box.current[0], "smallest current"),
        ("currentMax", "A", box.current[1], "largest current"),
    ]
    terms = [
        f"abs(displacement) > {1.0 + SLACK:g}*displacementMax",
        f"abs(velocity) > {1.0 + SLACK:g}*velocityMax",
        f"current < currentMin - {meter:g}",
        f"current > currentMax + {meter:g}",
    ]
    if box.temperature is not None:
        rows.append(("temperatureMin", "degC", box.temperature[0], "lowest temperature"))
        rows.append(("temperatureMax", "degC", box.temperature[1], "highest temperature"))
        terms.append(f"temperature < temperatureMin - {TEMPERATURE_SLACK:g}")
        terms.append(f"temperature > temperatureMax + {TEMPERATURE_SLACK:g}")
    parameters = "".join(
        f'    parameter Real {name}(unit="{unit}") = {value!r} "{told} of the card\'s tests";\n'
        for name, unit, value, told in rows
    )
    return parameters, "\n        or ".join(terms)


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
