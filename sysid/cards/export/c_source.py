"""A damper as C99 source: one function a piece, one step a sample, nothing allocated.

The pieces are C files of their own (`c/`), as a person would write them.  What is written here
is how they stand together: the structs of parameters and of the past, and the chain of calls
from the rod to the recorded force.  Every function takes the past and returns what follows from
it, so that equations which are solved for (springs, leaks) may be tried again and again.
"""

import textwrap
from dataclasses import dataclass

from sysid.cards.export.c_chain import chain
from sysid.cards.export.c_parts import WIDTH
from sysid.cards.export.identifier import ascii_text
from sysid.cards.export.pieces import FORMS, Number, Piece, Pieces, shared_sources
from sysid.cards.export.sources import source


@dataclass(frozen=True)
class Entry:
    """A number that a user may read and set, one each for a table's values.

    Attributes:
        symbol: As in the card.
        name: In words.
        unit: SI.
        value: In that unit.
        place: Where it stands in the parameters' struct.
    """

    symbol: str
    name: str
    unit: str
    value: float
    place: str


def entries_of(pieces: Pieces) -> tuple[Entry, ...]:
    """All parameters of a damper, in the order of its struct."""
    found = []
    for piece in pieces.all:
        currents = piece.currents
        for number in piece.numbers:
            if number.field in FORMS:
                continue
            place = f"{piece.member}.{number.field}"
            if not isinstance(number.value, tuple):
                found.append(Entry(number.symbol, number.name, number.unit, number.value, place))
                continue
            for k, (current, value) in enumerate(zip(currents, number.value, strict=True)):
                symbol, name = (z.format(f"{current:g}") for z in (number.symbol, number.name))
                found.append(Entry(symbol, name, number.unit, value, f"{place}[{k}]"))
    return tuple(found)


def signal_path(pieces: Pieces) -> str:
    """Everything between the types of a sample and the public functions, as C99."""
    shared = [source(f"{name}.c") for name in ("motion", *shared_sources(pieces))]
    shared.append(source("root.c"))
    kinds: dict[str, Piece] = {piece.kind: piece for piece in pieces.all}
    own = [_struct(piece) + _source(piece) for piece in kinds.values()]
    return "\n".join([*shared, *own, _parameters(pieces), _lines(pieces), *chain(pieces)])


def _source(piece: Piece) -> str:
    if piece.kind == "series_compliance":
        return ""
    folder = "valves" if piece.stage == "valve" else "effects"
    return source(f"{folder}/{piece.kind}.c")


def _struct(piece: Piece) -> str:
    rows = [_row(number) for number in piece.numbers]
    count = len(piece.currents)
    head = f"enum {{ {piece.kind.upper()}_CURRENTS = {count} }};\n\n" if count else ""
    return f"{head}typedef struct {{\n" + "".join(rows) + f"}} {piece.kind}_parameters;\n\n"


def _row(number: Number) -> str:
    size = f"[{len(number.value)}]" if isinstance(number.value, tuple) else ""
    name = number.name.replace(" at {} A", "").replace("{} ", "")
    return f"    double {number.field}{size}; /* {ascii_text(number.unit)}, {ascii_text(name)} */\n"


def _parameters(pieces: Pieces) -> str:
    rows = [f"    {p.kind}_parameters {p.member};\n" for p in pieces.all]
    values = ",\n".join(_values(p) for p in pieces.all)
    return (
        "/* Of the whole damper. */\ntypedef struct {\n" + "".join(rows) + "} parameters;\n\n"
        f"static const parameters OF_THE_CARD = {{\n{values},\n}};\n"
    )


def _values(piece: Piece) -> str:
    text = "{" + ", ".join(_literal(n.value) for n in piece.numbers) + "}"
    return textwrap.fill(text, WIDTH, initial_indent="    ", subsequent_indent="     ")


def _literal(value: float | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return "{" + ", ".join(map(_literal, value)) + "}"
    return repr(float(value))


def _lines(pieces: Pieces) -> str:
    rows = [f"    {p.kind}_line {p.member};\n" for p in pieces.all if p.memory == "line"]
    return (
        "/* Past samples of delayed signals; past beyond them is told by `too_short`. */\n"
        "typedef struct {\n" + ("".join(rows) or "    int none;\n") + "} lines;\n"
    )
