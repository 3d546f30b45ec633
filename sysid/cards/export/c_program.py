"""A card as a C99 program: header, source, and a test that computes the card's check vectors."""

import math
from typing import Final

from sysid.cards.export.box import conditions, ends, not_told, ranges
from sysid.cards.export.c_source import Entry, entries_of, signal_path
from sysid.cards.export.identifier import ascii_text, comment, identifier
from sysid.cards.export.pieces import Pieces
from sysid.cards.export.sources import filled, source, without_unused
from sysid.cards.schema import Card, Check

LIBRARIES: Final = "#include <math.h>\n#include <stddef.h>\n#include <string.h>\n"
_NUMBERS_OF_PAST: Final = 64
"""Doubles that one piece keeps at most, twice; generous, and checked where it is compiled."""
_DELAY_LINE: Final = 2 * 4096 + 8


def c_program(card: Card, pieces: Pieces, name: str) -> dict[str, str]:
    """The files of a C99 program.

    Args:
        card: What is exported.
        pieces: Of its damper.
        name: Of the files without ending, and the prefix of all public names; see `identifier`.

    Returns:
        File name → text: header, source, test.
    """
    assert name == identifier(name)
    entries = entries_of(pieces)
    marks = {"NAME": name, "UPPER": name.upper(), "COUNT": str(len(entries))}
    rows = "".join(map(_entry, entries))
    plant = not (pieces.channel or any(piece.memory == "line" for piece in pieces.all))
    header = filled(
        "header.h.in",
        _told(card, pieces)
        | {"IN_PLANT": source("in_plant.h.in") if plant else "", "MEMORY": str(_memory(pieces))}
        | marks,
    )
    instance = filled("instance.c", {"PLANT": source("plant.c") if plant else ""})
    api = filled(
        "api.c.in",
        {"ENTRIES": rows, "IN_PLANT": source("in_plant.c.in") if plant else ""} | marks,
    )
    box = filled("validity.c.in", {k: number(z) for k, z in ends(card, pieces).items()})
    text = "\n".join([signal_path(pieces), box, instance, api])
    body = [
        comment(f"{card.damper.name}: see {name}.h. Written by {card.software}; do not edit."),
        f'{LIBRARIES}\n#include "{name}.h"\n',
        without_unused(text),
    ]
    test = filled("test.c.in", marks | _driven(card) | {"VECTORS": _vectors(card)})
    return {f"{name}.h": header, f"{name}.c": "\n".join(body), f"{name}_test.c": test}


def _entry(entry: Entry) -> str:
    """A row of the table of parameters."""
    symbol, unit = ascii_text(entry.symbol), ascii_text(entry.unit)
    return f'    {{"{symbol}", "{unit}", offsetof(parameters, {entry.place})}},\n'


def _memory(pieces: Pieces) -> int:
    """Doubles that surely hold a damper."""
    numbers = len(entries_of(pieces)) + 16 * len(pieces.all)
    deep = 1
    for piece in pieces.motion:
        deep *= 2 if piece.kind == "series_compliance" else 1
    lines = sum(2 for piece in pieces.all if piece.memory == "line")
    return numbers + 2 * _NUMBERS_OF_PAST * deep * len(pieces.all) + lines * _DELAY_LINE


def _told(card: Card, pieces: Pieces) -> dict[str, str]:
    """What the header says of the card."""
    box = card.validity
    notes = [*card.known_discrepancies, *pieces.without_say]
    centre = f" (on the rig: {1e3 * box.centre:.4g} mm, compression positive)" if box.centre else ""
    return {
        "TITLE": ascii_text(f"{card.damper.name}, identified from {card.damper.campaign}"),
        "SOFTWARE": ascii_text(card.software),
        "MODEL": card.model,
        "CENTRE": centre,
        "VALID": comment(
            f"Identified at {conditions(card)}; beyond that the force is extrapolated. A step "
            f"tells a sample that is outside. One sample does not tell {not_told(card)}.",
            inside=True,
        ),
        "NOTES": "".join(comment(f"Note: {note}", inside=True) for note in notes),
    } | {name.upper(): told for name, told in ranges(card).items()}


def _vectors(card: Card) -> str:
    """The check vectors as arrays."""
    longest = max(len(check.time) for check in card.check)
    tables = ",\n".join(_vector(check) for check in card.check)
    lengths = ", ".join(str(len(check.time)) for check in card.check)
    return (
        f"enum {{ VECTORS = {len(card.check)} }};\n\n"
        f"static const int LENGTH[VECTORS] = {{{lengths}}};\n\n"
        "/* time, displacement, velocity, acceleration, current, temperature, force */\n"
        f"static const double CHECK[VECTORS][{longest}][7] = {{\n{tables},\n}};\n"
    )


def _vector(check: Check) -> str:
    temperature = check.temperature or (math.nan,) * len(check.time)
    columns = (
        check.time, check.displacement, check.velocity, check.acceleration, check.current,
        temperature, check.force,
    )  # fmt: skip
    rows = ",\n".join(
        "     {" + ", ".join(map(number, row)) + "}" for row in zip(*columns, strict=True)
    )
    return f"    {{\n{rows},\n    }}"


def number(value: float) -> str:
    """A number as C reads it."""
    if math.isinf(value):
        return "HUGE_VAL" if value > 0.0 else "-HUGE_VAL"
    return "NAN" if math.isnan(value) else repr(float(value))


def _driven(card: Card) -> dict[str, str]:
    """A motion about the card's limits, for the measurement of time."""
    box = card.validity
    amplitude = box.amplitude[1]
    temperature = math.nan if box.temperature is None else sum(box.temperature) / 2
    return {
        "AMPLITUDE": repr(0.5 * amplitude),
        "OMEGA": repr(0.8 * box.velocity[1] / amplitude),
        "CURRENT": repr(0.5 * sum(box.current)),
        "TEMPERATURE": number(temperature),
    }
